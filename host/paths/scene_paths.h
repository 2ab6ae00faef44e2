// The paths that a scene describes, ready for an engine.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/field/prepared_case.h"
#include "host/long_run.h"
#include "host/paths/motions.h"
#include "host/paths/recorded.h"
#include "host/reference/friction.h"
#include "host/scene/scene.h"
#include "shaders/shared/law.h"

namespace forceshade {

/// Reads a file of recorded paths for a scene: its positions must be within reach of the scene in T, its times keep to
/// the rate where the loop is closed. \throws as RecordedFile.
template <typename T>
std::shared_ptr<const RecordedFile> read_recorded(const PreparedCase& prepared, const std::filesystem::path& file) {
    const std::optional<PathsSpec>& paths = prepared.one.scene.paths;
    RecordedOptions options;
    options.largest_coordinate = largest_coordinate<T>(prepared);
    options.period = paths && paths->closed() ? 1 / paths->rate : 0;
    options.origin = scene_origin(prepared);
    Stage stage("reading " + file.filename().string(), 0, "MB");
    options.progress = [&](std::uint64_t done, std::uint64_t total) { stage.update(done / 1000000, total / 1000000); };
    return std::make_shared<const RecordedFile>(file, options);
}

/// Owns what a layout::PathInput only points to. Places are measured from scene_origin(). A batch's tables are made
/// when it is asked for, in double, and rounded once to T; a path depends on the seed and its number alone, neither on
/// its batch nor on T but for that rounding.
template <typename T> class ScenePaths final : public layout::PathSource<T> {
public:
    /// `prepared` must outlive it. `recorded`: the paths of a file in place of those of the scene, whose loop, drive,
    /// rate and hand are used. \throws UsageError for a scene without [paths] or with values beyond T, IoError.
    explicit ScenePaths(const PreparedCase& prepared, std::shared_ptr<const RecordedFile> recorded = nullptr);

    /// Points to this. Channels are those of the scene's output that paths have, and the position.
    layout::PathInput<T> input();

    /// m: the distance that a turn of the force is counted over.
    double stretch() const { return region_.stretch; }

    /// Paths of a mesh that began behind its surface, of those whose batch was made.
    std::uint64_t begins_inside() const { return inside_; }

    /// Warnings about the recorded file, `file:line:column: ...`, or in what is generated; and where T is too
    /// coarse for the steps or the depth.
    std::vector<std::string> warnings() const;
    /// The most samples of a batch of recorded paths, each path counted as long as the longest.
    void limit_batches(std::size_t samples);

    layout::PathBatch<T> batch(std::size_t first, std::size_t count) override;
    std::span<const T> positions(std::size_t step, std::size_t steps) override;

private:
    layout::PathBatch<T> generate(std::size_t first, std::size_t count);
    void add_path(std::size_t first, std::size_t path, std::size_t count);
    void start_proxies(const layout::PathBatch<T>& batch);
    std::optional<std::string> coarse() const;

    PathsSpec spec_;
    glm::dvec3 origin_; /* m, in the world: of the region and of all places */
    PathRegion region_;
    FieldTables<T> tables_;
    layout::Law<T> law_;                        // points into the tables
    layout::PathFeatures features_, generated_; // of the engine; of what is generated
    layout::HandParams<T> hand_{};
    std::optional<reference::SurfaceForces<T>> surface_;
    std::unique_ptr<RecordedPaths<T>> recorded_; // null: generated
    // Generated paths upon a mesh's surface: the engine takes them for recorded ones.
    const MeshStructure* below_ = nullptr;
    layout::PathBatch<T> batch_; // generated last
    std::size_t most_paths_ = 0; // of a batch
    std::vector<layout::uint> lengths_;
    std::vector<T> window_;
    std::vector<layout::MotionParams<T>> motions_;
    std::vector<T> amplitudes_;
    std::vector<layout::uint> phases_, phase_steps_;
    std::vector<layout::ProxyStart<T>> proxies_;
    std::uint64_t inside_ = 0;
    std::size_t counted_ = 0; // paths whose beginning is known
};

extern template class ScenePaths<float>;
extern template class ScenePaths<double>;

// Generated paths that cannot be what the scene says at its rate.

/// Which key, how many paths, and what would be right: paths that go half a round a sample or more, so that they seem
/// to go slower or back; paths that all end before they have been there and back once; paths so slow that whole phases
/// of 2^-32 rounds (of a spiral also of its way out and back) a sample miss their speed by more than a hundredth;
/// frequencies of half the rate or more. Of more than 65 536 paths the first 65 536 are checked.
std::vector<std::string> pace_warnings(const PathsSpec& paths, const PathRegion& region);

// The hand and the device of a scene, as an engine takes them.

/// In closed loop. The grip's spring pulls to the path along x and y, and along z unless the hand presses with a given
/// force; its damping acts on the speed against the path's, the device's on the speed. `bound`, m: PathRegion;
/// `stiffness`, N/m: the scene's, which a virtual coupling is in line with.
/// \throws UsageError if a value leaves the range of T.
template <typename T>
layout::HandParams<T> hand_params(const HandSpec& hand, const PathsSpec& paths, double bound, double stiffness);

// Mass, damping and spring over one sample, exactly (laws: sampled stability).

/// One axis: mass x'' + damping x' + stiffness (x - target) = force.
struct Axis {
    double mass = 0;      /* kg, positive */
    double damping = 0;   /* N s/m, not negative */
    double stiffness = 0; /* N/m, not negative */
};

/// Its exact map over `period` seconds during which target and force are held (zero-order hold): under-, over- and
/// critically damped, and without damping or spring. No coefficient loses digits where it is small against others.
layout::AxisMap<double> axis_map(const Axis& axis, double period);

} // namespace forceshade
