// The force laws for programs of one's own, in C++17: forceshade.h, whose contracts hold here too, with objects that
// free themselves and exceptions for errors. Link forceshade::forceshade.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "forceshade.h"

namespace forceshade {
// Not what the library itself calls by these names, which may be linked beside.
inline namespace v0 {

using Vector = std::array<double, 3>; /* x, y, z: m or N */
using Touch = fs_touch;
using ProbeState = fs_probe_state;

/// What is wrong, in the command line's words.
class Error : public std::runtime_error {
public:
    Error() : std::runtime_error(fs_last_error()), code_(fs_last_error_code()) {}
    fs_error code() const noexcept { return code_; }

private:
    fs_error code_;
};

/// \throws Error unless it is FS_OK
inline void check(fs_error error) {
    if (error != FS_OK)
        throw Error();
}

/// As fs_default_law() until something else is said.
struct Law : fs_law {
    Law() noexcept : fs_law(fs_default_law()) {}
};

/// Arrays as of fs_scene_from_mesh(); without corner_counts all facets are triangles.
struct Mesh {
    std::vector<Vector> vertices;
    std::vector<int> corners, corner_counts;

    std::size_t facets() const noexcept { return corner_counts.empty() ? corners.size() / 3 : corner_counts.size(); }
    const double* numbers() const noexcept { return vertices.empty() ? nullptr : vertices.front().data(); }
    const int* counts() const noexcept { return corner_counts.empty() ? nullptr : corner_counts.data(); }
    /// \throws std::invalid_argument if the counts are not those of the corners
    void check_counts() const {
        std::size_t sum = corner_counts.empty() ? 3 * facets() : 0;
        for (const int count : corner_counts)
            sum += count > 0 ? static_cast<std::size_t>(count) : 0;
        if (sum != corners.size())
            throw std::invalid_argument("a mesh's corner_counts do not add up to its corners");
    }
};

/// A surface and its force law. A copy shares all but the pose. \throws Error from what makes one
class Scene {
public:
    explicit Scene(const std::string& file, const std::string& overrides = "")
        : Scene(fs_scene_from_file(file.c_str(), overrides.c_str())) {}
    explicit Scene(const Mesh& mesh, const Law& law = {}) : Scene(from_mesh(mesh, law)) {}
    static Scene parse(const std::string& text, const std::string& folder = ".", const std::string& overrides = "") {
        return Scene(fs_scene_from_toml(text.c_str(), folder.c_str(), overrides.c_str()));
    }
    static Scene parse(const std::string& text, const Mesh& mesh, const std::string& overrides = "") {
        mesh.check_counts();
        return Scene(fs_scene_from_toml_and_mesh(text.c_str(), overrides.c_str(), mesh.numbers(), mesh.vertices.size(),
                                                 mesh.corners.data(), mesh.counts(), mesh.facets()));
    }
    Scene(const Scene& other) : Scene(fs_scene_copy(other.get())) {}
    Scene& operator=(const Scene& other) { return *this = Scene(other); }
    Scene(Scene&&) noexcept = default;
    Scene& operator=(Scene&&) noexcept = default;

    const char* toml() const noexcept { return fs_scene_toml(get()); }
    const char* warnings() const noexcept { return fs_scene_warnings(get()); }

    /// By rows. \throws Error
    void pose(const std::array<double, 9>& rotation, const Vector& translation) {
        check(fs_scene_pose(get(), rotation.data(), translation.data()));
    }
    Touch at(const Vector& place) const noexcept { return fs_scene_at(get(), place.data()); }
    /// \throws Error
    std::vector<Touch> at(const std::vector<Vector>& places, unsigned threads = 0) const {
        std::vector<Touch> touches(places.size());
        if (!places.empty())
            check(fs_scene_at_many(get(), places.front().data(), places.size(), touches.data(), threads));
        return touches;
    }
    fs_scene* get() const noexcept { return scene_.get(); }

private:
    static fs_scene* from_mesh(const Mesh& mesh, const Law& law) {
        mesh.check_counts();
        return fs_scene_from_mesh(mesh.numbers(), mesh.vertices.size(), mesh.corners.data(), mesh.counts(),
                                  mesh.facets(), &law);
    }
    explicit Scene(fs_scene* made) : scene_(made) {
        if (!made)
            throw Error();
    }

    struct Free {
        void operator()(fs_scene* scene) const noexcept { fs_scene_free(scene); }
    };
    std::unique_ptr<fs_scene, Free> scene_;
};

/// A probe with a history, in the pose of the scene that it was made of.
class Probe {
public:
    /// \throws Error
    explicit Probe(const Scene& scene) : probe_(fs_probe_new(scene.get())) {
        if (!probe_)
            throw Error();
    }

    Touch step(const Vector& place) noexcept { return fs_probe_step(get(), place.data()); }
    void reset() noexcept { fs_probe_reset(get()); }
    ProbeState state() const noexcept { return fs_probe_get_state(get()); }
    /// \throws Error
    void set_state(const ProbeState& state) { check(fs_probe_set_state(get(), &state)); }
    fs_probe* get() const noexcept { return probe_.get(); }

private:
    struct Free {
        void operator()(fs_probe* probe) const noexcept { fs_probe_free(probe); }
    };
    std::unique_ptr<fs_probe, Free> probe_;
};

/// N/m; as fs_critical_stiffness().
inline double critical_stiffness(double mass, double damping, double sample_time, unsigned delay_samples = 0) noexcept {
    return fs_critical_stiffness(mass, damping, sample_time, delay_samples);
}

} // namespace v0
} // namespace forceshade
