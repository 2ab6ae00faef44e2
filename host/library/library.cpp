#include <algorithm>
#include <cmath>
#include <cstring>
#include <exception>
#include <filesystem>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "host/error.h"
#include "host/field/case_law.h"
#include "host/library/forceshade.h"
#include "host/limits/critical_stiffness.h"
#include "host/mesh/mesh_file.h"
#include "host/reference/chunks.h"
#include "host/text.h"

namespace forceshade {
namespace {

using Law = std::variant<CaseLaw<float>, CaseLaw<double>>;

Law law_of(const PreparedCase& prepared) {
    return in_precision(prepared.one.scene.precision,
                        [&]<typename T>(std::type_identity<T>) -> Law { return CaseLaw<T>(prepared); });
}

/// What handles of a scene share; nothing that is seen changes.
class SceneTables {
public:
    SceneTables(const Case& one, const std::vector<std::string>& remarks, const PolygonFile* mesh = nullptr)
        : prepared_(CasePreparation().prepare(one, mesh)), law_(law_of(prepared_)), id_(scene_id(prepared_)) {
        for (const auto& lines : {remarks, prepared_.warnings})
            for (const std::string& line : lines)
                warnings_ += (warnings_.empty() ? "" : "\n") + line;
    }

    const std::string& toml() const { return prepared_.scene; }
    const std::string& warnings() const { return warnings_; }
    std::uint64_t id() const { return id_; }
    std::size_t triangles() const { return prepared_.images.mesh ? prepared_.images.mesh->structure.triangles() : 0; }
    const Law& law() const { return law_; }
    /// With what makes paths faster, which takes a while the first time.
    const Law& path_law() const {
        std::call_once(path_law_once_, [&] {
            path_law_.emplace(law_of(prepared_));
            std::visit([](auto& law) { law.find_obstacles(); }, *path_law_);
        });
        return *path_law_;
    }

private:
    PreparedCase prepared_;
    Law law_;
    std::uint64_t id_;
    std::string warnings_;
    mutable std::once_flag path_law_once_;
    mutable std::optional<Law> path_law_;
};

/// Where the object is.
struct Pose {
    bool moved = false;
    glm::dmat3 rotation{1};    // columns first
    glm::dvec3 translation{0}; /* m */

    glm::dvec3 to_object(const glm::dvec3& place) const noexcept {
        return moved ? (place - translation) * rotation : place; // by the transposed
    }
    glm::dvec3 place_in_world(const glm::dvec3& place) const noexcept {
        return moved ? rotation * place + translation : place;
    }
    glm::dvec3 direction_in_world(const glm::dvec3& direction) const noexcept {
        return moved ? rotation * direction : direction;
    }
};

glm::dvec3 vector_of(const double* numbers) noexcept {
    return {numbers[0], numbers[1], numbers[2]};
}

void store(const glm::dvec3& vector, double* numbers) noexcept {
    for (int i = 0; i < 3; ++i)
        numbers[i] = vector[i];
}

/// `place`: of the probe, m, in the world.
fs_touch touch_of(const Pose& pose, const ProbeContact& contact, const glm::dvec3& place) noexcept {
    fs_touch touch{};
    const bool touching = contact.facet != layout::kNoFacet;
    store(pose.direction_in_world(contact.force), touch.force);
    store(pose.moved && !touching ? place : pose.place_in_world(contact.proxy), touch.proxy);
    touch.depth = contact.depth;
    touch.facet = touching ? static_cast<int>(contact.facet) : -1;
    touch.status = !contact.finished ? FS_UNFINISHED : touching ? FS_TOUCHING : FS_FREE;
    return touch;
}

fs_touch no_answer(const glm::dvec3& place) noexcept {
    fs_touch touch{};
    store(place, touch.proxy);
    touch.facet = -1;
    touch.status = reference::is_finite(place) ? FS_OUT_OF_RANGE : FS_NOT_A_NUMBER;
    return touch;
}

/// A law, and what it remembers of a probe.
template <typename T> struct Followed {
    const CaseLaw<T>& law;
    typename CaseLaw<T>::Path path{};
    reference::Neighbourhood<T> around{};
};

template <typename T>
fs_touch touch_without_history(const CaseLaw<T>& law, const Pose& pose, const glm::dvec3& place,
                               layout::uint& hint) noexcept {
    const glm::dvec3 probe = pose.to_object(place);
    return law.reaches(probe) ? touch_of(pose, law.widened({law.at(probe, hint)}), place) : no_answer(place);
}

template <typename T> fs_touch next_touch(Followed<T>& followed, const Pose& pose, const glm::dvec3& place) noexcept {
    auto& [law, path, around] = followed;
    const glm::dvec3 probe = pose.to_object(place);
    if (law.reaches(probe))
        return touch_of(pose, law.widened(law.follow(path, around, probe)), place);
    path.begun = false;
    return no_answer(place);
}

// Errors: the thread's last, in memory that is there from its start.

constexpr std::size_t kLongestText = 4096;
thread_local char last_text[kLongestText];
thread_local fs_error last_error = FS_OK;

fs_error fail(fs_error error, const char* text) noexcept {
    std::strncpy(last_text, text, kLongestText - 1);
    return last_error = error;
}

struct BadArgument : std::runtime_error {
    using std::runtime_error::runtime_error;
};

fs_error fail_with_current_exception() noexcept {
    try {
        throw;
    } catch (const BadArgument& error) {
        return fail(FS_ARGUMENT, error.what());
    } catch (const Error& error) {
        return fail(error.code() == ExitCode::usage ? FS_SCENE
                    : error.code() == ExitCode::io  ? FS_FILE
                                                    : FS_FAILED,
                    error.what());
    } catch (const std::exception& error) {
        return fail(FS_FAILED, error.what());
    } catch (...) {
        return fail(FS_FAILED, "unknown error");
    }
}

template <typename Make> auto made(const Make& make) noexcept -> decltype(make()) {
    try {
        return make();
    } catch (...) {
        fail_with_current_exception();
        return nullptr;
    }
}

template <typename Pointer> Pointer required(Pointer pointer, const char* name) {
    if (!pointer)
        throw BadArgument(fmt::format("{} is NULL", name));
    return pointer;
}

/// Lines "key = value".
std::vector<Override> overrides_of(const char* text) {
    std::vector<Override> overrides;
    for (std::string_view rest = text ? text : ""; !rest.empty();) {
        const std::string_view line = rest.substr(0, rest.find('\n'));
        rest.remove_prefix(std::min(rest.size(), line.size() + 1));
        if (trimmed(line).empty())
            continue;
        const std::size_t sign = line.find('=');
        if (sign == std::string_view::npos)
            throw BadArgument(fmt::format(
                "override \"{}\": it is a key and a value, as in \"force.stiffness = 1 N/mm\"", trimmed(line)));
        overrides.emplace_back(trimmed(line.substr(0, sign)), trimmed(line.substr(sign + 1)));
    }
    return overrides;
}

struct MeshArrays {
    const double* vertices;
    std::size_t vertex_count;
    const int* corners;
    const int* corner_counts;
    std::size_t facets;

    PolygonFile polygons(bool normals) const {
        std::vector<std::size_t> counts(facets, 3);
        std::size_t all = 0;
        for (std::size_t facet = 0; facet < facets; ++facet) {
            if (corner_counts && corner_counts[facet] < 0)
                throw BadArgument(fmt::format("facet {} has {} corners", facet, corner_counts[facet]));
            if (corner_counts)
                counts[facet] = static_cast<std::size_t>(corner_counts[facet]);
            all += counts[facet];
        }
        if (vertex_count > 0)
            required(vertices, "vertices");
        if (all > 0)
            required(corners, "corners");
        std::vector<glm::dvec3> places(vertex_count);
        for (std::size_t vertex = 0; vertex < vertex_count; ++vertex)
            places[vertex] = vector_of(vertices + 3 * vertex);
        return polygons_of("mesh", std::move(places), std::vector<std::int64_t>(corners, corners + all), counts,
                           normals);
    }
};

template <typename Name> std::string name_of(int value, const Name& names, const char* what) {
    if (value < 0 || static_cast<std::size_t>(value) >= std::size(names))
        throw BadArgument(fmt::format("{} {} is none", what, value));
    return names[static_cast<std::size_t>(value)];
}

std::vector<Override> overrides_of(const fs_law& law) {
    constexpr const char* kShadings[] = {"none", "morgenbesser", "barycentric", "mean_value", "two_pass"};
    constexpr const char* kPrecisions[] = {"f32", "f64"};
    constexpr const char* kOrientations[] = {"file", "outward"};
    if (!std::isfinite(law.stiffness) || !std::isfinite(law.weld))
        throw BadArgument("a law's stiffness and weld are finite numbers");
    return {{"force.stiffness", fmt::format("{} N/m", law.stiffness)},
            {"force.shading", name_of(law.shading, kShadings, "shading")},
            {"run.precision", name_of(law.precision, kPrecisions, "precision")},
            {"surface.weld", fmt::format("{} m", law.weld)},
            {"surface.orient", name_of(law.orientation, kOrientations, "orientation")}};
}

} // namespace
} // namespace forceshade

struct fs_scene {
    std::shared_ptr<const forceshade::SceneTables> tables;
    std::shared_ptr<forceshade::Pose> pose = std::make_shared<forceshade::Pose>(); // the probes' too
};

struct fs_probe {
    template <typename T> using Followed = forceshade::Followed<T>;
    using InPrecision = std::variant<Followed<float>, Followed<double>>;

    explicit fs_probe(const fs_scene& scene)
        : tables(scene.tables), pose(scene.pose),
          followed(
              std::visit([]<typename T>(const forceshade::CaseLaw<T>& law) -> InPrecision { return Followed<T>{law}; },
                         tables->path_law())) {}

    std::shared_ptr<const forceshade::SceneTables> tables;
    std::shared_ptr<const forceshade::Pose> pose;
    InPrecision followed;
};

using namespace forceshade; // of C's functions alone

int fs_version() {
    return FORCESHADE_VERSION_MAJOR * 10000 + FORCESHADE_VERSION_MINOR * 100 + FORCESHADE_VERSION_PATCH;
}

fs_error fs_last_error_code() {
    return last_error;
}

const char* fs_last_error() {
    return last_text;
}

fs_law fs_default_law() {
    const ForceSpec force;
    return {force.stiffness, FS_SHADING_NONE, FS_F32, MeshSpec().weld, FS_ORIENT_AS_GIVEN};
}

fs_scene* fs_scene_from_file(const char* file, const char* overrides) {
    return made([&] {
        std::vector<std::string> warnings;
        const Case one = read_scene(required(file, "file"), overrides_of(overrides), &warnings);
        return new fs_scene{std::make_shared<SceneTables>(one, warnings)};
    });
}

fs_scene* fs_scene_from_toml(const char* text, const char* folder, const char* overrides) {
    return made([&] {
        std::vector<std::string> warnings;
        const Case one = parse_scene(required(text, "text"), "scene", std::filesystem::absolute(folder ? folder : "."),
                                     overrides_of(overrides), &warnings);
        return new fs_scene{std::make_shared<SceneTables>(one, warnings)};
    });
}

namespace {

/// The file of the text's mesh is the arrays.
fs_scene* scene_of(const char* text, std::vector<Override> overrides, const MeshArrays& mesh) {
    overrides.insert(overrides.begin(), {"surface.file", "mesh"});
    std::vector<std::string> warnings;
    const Case one = parse_scene(text, "scene", std::filesystem::absolute("."), overrides, &warnings);
    if (one.scene.surface.kind != SurfaceKind::mesh)
        throw UsageError("a mesh is for a scene with kind = \"mesh\" in [surface]");
    const PolygonFile file = mesh.polygons(one.scene.surface.mesh.normals == NormalWeights::file);
    return new fs_scene{std::make_shared<SceneTables>(one, warnings, &file)};
}

} // namespace

fs_scene* fs_scene_from_mesh(const double* vertices, size_t vertex_count, const int* corners, const int* corner_counts,
                             size_t facets, const fs_law* law) {
    return made([&] {
        return scene_of("[surface]\nkind = \"mesh\"\n", overrides_of(law ? *law : fs_default_law()),
                        {vertices, vertex_count, corners, corner_counts, facets});
    });
}

fs_scene* fs_scene_from_toml_and_mesh(const char* text, const char* overrides, const double* vertices,
                                      size_t vertex_count, const int* corners, const int* corner_counts,
                                      size_t facets) {
    return made([&] {
        return scene_of(required(text, "text"), overrides_of(overrides),
                        {vertices, vertex_count, corners, corner_counts, facets});
    });
}

fs_scene* fs_scene_copy(const fs_scene* scene) {
    return made([&] { return new fs_scene{required(scene, "scene")->tables, std::make_shared<Pose>(*scene->pose)}; });
}

void fs_scene_free(fs_scene* scene) {
    delete scene;
}

const char* fs_scene_toml(const fs_scene* scene) {
    return scene->tables->toml().c_str();
}

const char* fs_scene_warnings(const fs_scene* scene) {
    return scene->tables->warnings().c_str();
}

fs_error fs_scene_pose(fs_scene* scene, const double rotation[9], const double translation[3]) {
    constexpr double kClose = 1e-6;
    Pose pose{true};
    if (rotation)
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < 3; ++column)
                pose.rotation[column][row] = rotation[3 * row + column];
    const glm::dmat3 product = glm::transpose(pose.rotation) * pose.rotation;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            if (!(std::abs(product[i][j] - (i == j ? 1 : 0)) <= kClose))
                return fail(FS_ARGUMENT, "a pose's rotation is orthonormal to 1e-6");
    if (!(glm::determinant(pose.rotation) > 0))
        return fail(FS_ARGUMENT, "a pose's rotation is no mirror: its determinant is positive");
    if (translation)
        pose.translation = vector_of(translation);
    if (!reference::is_finite(pose.translation))
        return fail(FS_ARGUMENT, "a pose's translation is finite");
    pose.moved = rotation || translation;
    *scene->pose = pose;
    return FS_OK;
}

fs_touch fs_scene_at(const fs_scene* scene, const double place[3]) {
    layout::uint hint = 0;
    return std::visit([&](const auto& law) { return touch_without_history(law, *scene->pose, vector_of(place), hint); },
                      scene->tables->law());
}

fs_error fs_scene_at_many(const fs_scene* scene, const double* places, size_t count, fs_touch* touches,
                          unsigned threads) {
    constexpr std::size_t kShare = 64; // places that a thread takes at once
    const Pose pose = *scene->pose;
    return std::visit(
        [&](const auto& law) {
            const auto evaluate = [&](std::size_t begin, std::size_t end) noexcept {
                layout::uint hint = 0;
                for (std::size_t i = begin; i < end; ++i)
                    touches[i] = touch_without_history(law, pose, vector_of(places + 3 * i), hint);
            };
            const std::size_t shares = count / kShare + (count % kShare != 0);
            const std::size_t used = std::min<std::size_t>(reference::threads_for(threads), shares);
            if (used < 2) {
                evaluate(0, count);
                return FS_OK;
            }
            try {
                reference::share_out(used, shares, [&](std::size_t, std::size_t share) {
                    evaluate(share * kShare, std::min(count, (share + 1) * kShare));
                });
                return FS_OK;
            } catch (...) {
                return fail_with_current_exception();
            }
        },
        scene->tables->law());
}

fs_probe* fs_probe_new(const fs_scene* scene) {
    return made([&] { return new fs_probe(*required(scene, "scene")); });
}

void fs_probe_free(fs_probe* probe) {
    delete probe;
}

fs_touch fs_probe_step(fs_probe* probe, const double place[3]) {
    return std::visit([&](auto& followed) { return next_touch(followed, *probe->pose, vector_of(place)); },
                      probe->followed);
}

void fs_probe_reset(fs_probe* probe) {
    std::visit([](auto& followed) { followed.path.begun = false; }, probe->followed);
}

fs_probe_state fs_probe_get_state(const fs_probe* probe) {
    fs_probe_state state{};
    state.scene = probe->tables->id();
    std::visit(
        [&](const auto& followed) {
            const auto& proxy = followed.path.proxy;
            if (!followed.path.begun)
                return;
            state.begun = 1;
            state.count = proxy.count;
            state.cornered = proxy.cornered;
            store(glm::dvec3(proxy.proxy), state.proxy);
            std::copy_n(proxy.triangles, proxy.count, state.triangles);
        },
        probe->followed);
    return state;
}

fs_error fs_probe_set_state(fs_probe* probe, const fs_probe_state* state) {
    if (state->scene != probe->tables->id())
        return fail(FS_ARGUMENT, "the probe's state is of another scene");
    const glm::dvec3 place = vector_of(state->proxy);
    const std::size_t triangles = probe->tables->triangles();
    bool possible = state->begun <= 1 && state->cornered <= 1 && state->count <= 3 && reference::is_finite(place);
    possible = possible && (state->begun == 0 || triangles > 0) && (state->cornered == 0 || state->count > 0);
    for (std::uint32_t i = 0; i < 3 && possible; ++i)
        possible = i >= state->count || state->triangles[i] < triangles;
    const auto set = [&]<typename T>(Followed<T>& followed) {
        if (!possible || !(reference::largest_coordinate(reference::Vector<T>(place)) <= T(kMeshReach<T>)))
            return fail(FS_ARGUMENT, "no probe has such a state");
        typename CaseLaw<T>::Path path;
        path.begun = state->begun != 0;
        path.proxy.started = path.begun;
        path.proxy.proxy = reference::Vector<T>(place);
        path.proxy.count = state->count;
        path.proxy.cornered = state->cornered != 0;
        std::copy_n(state->triangles, state->count, path.proxy.triangles);
        followed.path = path;
        return FS_OK;
    };
    return std::visit(set, probe->followed);
}

double fs_critical_stiffness(double mass, double damping, double sample_time, unsigned delay_samples) {
    return critical_stiffness(mass, damping, sample_time, delay_samples);
}
