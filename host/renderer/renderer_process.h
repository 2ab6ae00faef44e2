// A renderer of the user's own (forceshade_renderer.h) in a process of its own: what it does wrong ends that process,
// not this one.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <sys/types.h>
#include <vector>

#include <glm/vec3.hpp>

#include "host/error.h"
#include "host/field/case_law.h"
#include "host/field/prepared_case.h"

namespace forceshade {

/// What --renderer names.
struct RendererSource {
    std::filesystem::path library; /* absolute */
    std::string options;
    std::string name; /* the library's file without "lib" and ".so", and the options: "mine", "mine:fast" */
};

/// "LIBRARY[:OPTIONS]". \throws UsageError for an empty name, IoError for a file that is not there.
RendererSource parse_renderer(const std::string& text);
/// Several, whose names differ: the second "mine" is "mine (2)".
std::vector<RendererSource> parse_renderers(const std::vector<std::string>& texts);

struct RendererAnswer {
    glm::dvec3 force; /* N: as the renderer gave it, perhaps not finite */
    glm::dvec3 proxy; /* m; of a renderer that gives none the probe */
    bool has_proxy;
    double seconds; /* s: that its update took */
};

/// What a renderer did wrong: "crashed (Segmentation fault) in update 1000". Nothing can be asked of it any more.
class RendererError : public Error {
public:
    RendererError(const std::string& message, std::optional<std::uint64_t> of_update)
        : Error(ExitCode::failed, message), update(of_update) {}
    std::optional<std::uint64_t> update; // of all, from 0; none: it happened outside of one
};

/// How long a renderer may take.
struct RendererPatience {
    std::chrono::milliseconds open{60000}, update{2000};
};

class RendererProcess {
public:
    /// Opens a renderer of a case, updated each `period`, s, and waits until it is ready. The thread that calls this
    /// must outlive the object. \throws RendererError, IoError where no process can be made.
    RendererProcess(const RendererSource& source, const PreparedCase& prepared, double period,
                    const RendererPatience& patience = {});
    ~RendererProcess();
    RendererProcess(const RendererProcess&) = delete;
    RendererProcess& operator=(const RendererProcess&) = delete;

    /// The next update begins a path.
    void begin_path() noexcept { begins_ = true; }
    struct How {
        bool cold = false;        /* each update with caches full of other memory */
        bool each_begins = false; /* each begins a path */
    };
    /// Updates at places, m, one after the other. \throws RendererError, Interrupted.
    std::vector<RendererAnswer> update(std::span<const glm::dvec3> probes, const How& how);
    std::vector<RendererAnswer> update(std::span<const glm::dvec3> probes) { return update(probes, {}); }
    /// One update; allocates nothing unless it throws, as above.
    RendererAnswer update(const glm::dvec3& probe);

    /// Ends it, by fsr_close if it still answers. What went wrong in that: "crashed (Aborted) in fsr_close", or
    /// nothing.
    std::string close() noexcept;

private:
    struct Shared;
    void put(std::size_t item, const glm::dvec3& probe) noexcept;
    RendererAnswer answer(std::size_t item) const noexcept;
    void ask(std::uint32_t what, std::chrono::milliseconds patience);
    [[noreturn]] void fail(const std::string& what);
    std::string where() const;
    std::string how_it_ended() const;
    void kill() noexcept;

    std::size_t bytes_ = 0;
    Shared* shared_ = nullptr;
    pid_t child_ = -1;
    RendererPatience patience_;
    bool begins_ = true;
    bool open_ = false; /* it answers */
    std::uint64_t updates_ = 0;
};

/// A renderer's forces as the law of a live loop, for simulated hands. After an error the force is NaN, which the loop
/// does not display, and `failure` says what it was; the loop's thread writes that.
class RendererLaw final : public ProbeLaw {
public:
    /// \throws as RendererProcess.
    RendererLaw(const RendererSource& source, const PreparedCase& prepared, double period,
                std::shared_ptr<std::string> failure);

    bool reaches(const glm::dvec3& probe) const noexcept override;
    void begin_path() noexcept override {
        renderer_.begin_path();
        lag_ = -1;
    }
    void couple(double scale, double period) noexcept override {
        coupling_ = coupling_of<double>(hand_, scale * stiffness_, period);
    }
    ProbeContact at(const glm::dvec3& probe) noexcept override;

private:
    RendererProcess renderer_;
    double stiffness_; /* N/m */
    HandSpec hand_;
    layout::Coupling<double> coupling_{};
    double lag_ = -1; /* m: of the coupling */
    std::shared_ptr<std::string> failure_;
    bool interrupted_ = false;
};

/// The child's part: serves the library until it is ended. The exchange is the file descriptor kRendererDescriptor.
int serve_renderer(const std::string& library);

/// The hidden command of the program that calls serve_renderer.
inline constexpr const char* kRendererCommand = "__renderer";

// What a renderer gets of a scene.

struct RendererMesh {
    std::vector<glm::dvec3> vertices;          /* m */
    std::vector<std::array<int, 3>> triangles; /* counterclockwise from outside */
    double extent = 0;                         /* m: of an analytic surface that is cut off */
};

RendererMesh renderer_mesh(const PreparedCase& prepared);

} // namespace forceshade
