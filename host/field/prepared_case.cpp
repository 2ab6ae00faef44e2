#include "host/field/prepared_case.h"

#include <algorithm>

#include <fmt/format.h>

#include "host/error.h"
#include "host/field/scene_mesh.h"
#include "host/io/height_image.h"

namespace forceshade {
namespace {

// In memory between cases: a sweep over files must not keep them all.
constexpr std::size_t kImages = 4;
constexpr std::size_t kMeshes = 2;

// The newest first; made by `read` unless it is there.
template <typename Key, typename File, typename Read>
std::shared_ptr<const File> kept(std::deque<std::pair<Key, std::shared_ptr<const File>>>& files, const Key& key,
                                 std::size_t most, const Read& read) {
    const auto known = std::find_if(files.begin(), files.end(), [&](const auto& one) { return one.first == key; });
    if (known != files.end())
        return known->second;
    files.emplace_front(key, read());
    if (files.size() > most)
        files.pop_back();
    return files.front().second;
}

void check_digest(const std::string& file, const std::string& expected, const std::string& found) {
    if (!expected.empty() && expected != found)
        throw UsageError(fmt::format("{} is not the file that the scene means: its SHA-256 is {}, the scene says {}",
                                     file, found, expected));
}

} // namespace

std::shared_ptr<const HeightImage> CasePreparation::image(HeightMapSpec& map) {
    if (map.function != MapFunction::file)
        return nullptr;
    const auto image = kept(images_, map.path, kImages,
                            [&] { return std::make_shared<const HeightImage>(read_height_image(map.path)); });
    check_digest(map.file, map.sha256, image->sha256);
    map.sha256 = image->sha256;
    return image;
}

std::shared_ptr<const SceneMesh> CasePreparation::mesh(MeshSpec& spec) {
    MeshSpec placed = spec;
    placed.sha256.clear();
    const auto mesh = kept(meshes_, placed, kMeshes, [&] { return read_scene_mesh(placed); });
    check_digest(spec.file, spec.sha256, mesh->sha256);
    spec.sha256 = mesh->sha256;
    return mesh;
}

PreparedCase CasePreparation::prepare(const Case& one) {
    PreparedCase prepared;
    prepared.one = one;
    Scene& scene = prepared.one.scene;
    if (scene.surface.kind == SurfaceKind::height_map)
        prepared.images.map = image(scene.surface.map);
    if (scene.texture)
        prepared.images.texture = image(scene.texture->map);
    if (scene.surface.kind == SurfaceKind::mesh) {
        prepared.images.mesh = mesh(scene.surface.mesh);
        const bool winding = scene.surface.mesh.inside == InsideTest::winding;
        prepared.warnings = warnings_of(scene.surface.mesh, *prepared.images.mesh,
                                        winding ? MeshUse::winding_field : MeshUse::pseudonormal_field);
        check_mesh_fits(scene, *prepared.images.mesh);
        if (scene.grid.samples)
            scene.grid = fitted_grid(scene.grid.samples, prepared.images.mesh->mesh);
    }
    prepared.scene = resolved_toml(prepared.one);
    return prepared;
}

} // namespace forceshade
