// A kernel put in the place of the program's, and what `validate` says of it, in a process of its own: a kernel that
// was changed may crash the driver or never end.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "host/field/prepared_case.h"
#include "tests/mutation/kernel_code.h"

namespace forceshade::mutation {

/// A kernel of the program in one precision, as `validate` runs it on the software device.
struct Kernel {
    const char* name; /* "mesh_path" */
    Precision precision;
    bool mesh, paths; /* what scenes it is for */
    std::span<const std::uint32_t> words, with_lines;
    std::uint32_t marks;  /* the binding that shows what ran: a buffer that no kernel reads */
    layout::uint channel; /* in which the host sees the beginning of that buffer */
};
const std::vector<Kernel>& kernels();

/// The scenes of a folder, in the order of their names. \throws what CasePreparation throws.
std::vector<PreparedCase> load_scenes(const std::string& folder);

/// Whether a kernel runs in a scene.
bool is_for(const Kernel& kernel, const PreparedCase& scene);

enum class End { survived, differs, error, crash, time };

struct Outcome {
    End end = End::survived;
    bool left_to_host =
        false; /* of a survivor: other steps of a mesh's paths were left to the host, with the same result */
    std::size_t scene = 0; /* that showed it; of a crash or a time-out not known */
};

/// What one process does.
struct Trial {
    Words words;
    std::vector<std::uint64_t> host_updates; /* of the intact kernel, by scene; may be empty */
    std::vector<std::size_t> scenes;         /* in this order, until one shows a difference */
};

/// Runs `validate`'s comparison on changed kernels, so many processes at a time; `done` takes what came of each. A
/// process that takes more than `seconds` of processor time for a scene is ended.
void try_kernels(const Kernel& kernel, const std::vector<PreparedCase>& scenes, std::size_t trials,
                 const std::function<Trial(std::size_t)>& trial,
                 const std::function<void(std::size_t, const Outcome&)>& done, unsigned jobs, unsigned seconds);

/// Updates of proxies that an intact kernel leaves to the host in each scene. \throws std::runtime_error for a scene in
/// which it fails.
std::vector<std::uint64_t> host_updates_of(const Kernel& kernel, const std::vector<PreparedCase>& scenes);

/// Which of some blocks of a kernel run in each scene: by scene, then by the number of the block among all; false for
/// the others. \throws std::runtime_error if a scene could not be run.
std::vector<std::vector<bool>> coverage_of(const Kernel& kernel, const KernelCode& code,
                                           const std::vector<PreparedCase>& scenes,
                                           const std::vector<std::size_t>& blocks);

} // namespace forceshade::mutation
