// The force laws for programs of one's own: link forceshade::reference (find_package(forceshade)). Numbers are those of
// `forceshade field` and `forceshade explore`, digit for digit. C++20, the standard library alone.
#pragma once

#include <array>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#define FORCESHADE_API __attribute__((visibility("default")))

namespace forceshade::oracle {

/// m: x, y, z.
using Place = std::array<double, 3>;

/// Why there is a force, or none.
enum class Status {
    free,
    touching,
    unfinished,   /* touching, and the proxy did not come to rest: no force is larger for it */
    out_of_range, /* no answer: too far from the scene for the precision */
    not_a_number, /* no answer: a coordinate is NaN or infinite */
};

/// What a probe meets, in the scene's precision; a float stands here exactly.
struct Touch {
    Status status = Status::free;
    std::array<double, 3> force{}; /* N; 0 out of contact */
    std::array<double, 3> proxy{}; /* m, in the world: where the surface is touched; out of contact the probe */
    double depth = 0;              /* m; 0 out of contact */
    long facet = -1;               /* its number; -1 out of contact */
};

/// What is wrong with a scene or its files, in the command line's words.
class FORCESHADE_API SceneError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// A polygon mesh: vertices in the unit that the scene states, and the numbers of each facet's corners, from 0 on,
/// counterclockwise seen from outside.
struct Mesh {
    std::vector<Place> vertices;
    std::vector<std::vector<int>> facets;
};

/// A scene, ready to evaluate. Copies are cheap and share everything; nothing changes, so threads may share it, too.
class FORCESHADE_API Scene {
public:
    /// Keys that replace those of the scene: {"surface.radius", "700 mil"}.
    using Overrides = std::vector<std::pair<std::string, std::string>>;

    /// The scene in a TOML file. \throws SceneError
    explicit Scene(const std::string& file, const Overrides& overrides = {});
    /// The same from TOML text; files that it names are relative to `folder`. \throws SceneError
    static Scene parse(const std::string& text, const std::string& folder = ".", const Overrides& overrides = {});

    /// The same where the mesh stands for the file of surface.kind = "mesh". \throws SceneError
    static Scene parse(const std::string& text, const Mesh& mesh, const Overrides& overrides = {});

    /// The scene as complete TOML.
    const std::string& toml() const;
    /// What is remarkable in it, or in its mesh.
    const std::vector<std::string>& warnings() const;
    /// What a probe meets that has no history. Neither allocates nor locks.
    Touch at(const Place& place) const noexcept;

private:
    friend class Probe;
    struct State;
    explicit Scene(std::shared_ptr<const State> state);
    std::shared_ptr<const State> state_;
};

/// A probe with a history, as a haptic loop has it: on a mesh its proxy (the god-object) stays on the side where it
/// began. For one thread at a time.
class FORCESHADE_API Probe {
public:
    explicit Probe(const Scene& scene);
    ~Probe();
    Probe(Probe&&) noexcept;
    Probe& operator=(Probe&&) noexcept;

    /// What it meets at its next place; without an answer the path ends, and the next place begins another.
    /// Neither allocates nor locks.
    Touch step(const Place& place) noexcept;
    /// Forgets the past: the next place begins a path.
    void begin_path() noexcept;

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace forceshade::oracle
