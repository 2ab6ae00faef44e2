#include "host/field/prepared_case.h"

#include <algorithm>

#include <fmt/format.h>

#include "host/error.h"
#include "host/io/height_image.h"

namespace forceshade {
namespace {

constexpr std::size_t kImages = 4; // in memory between cases: a sweep over images must not keep them all

} // namespace

std::shared_ptr<const HeightImage> CasePreparation::image(HeightMapSpec& map) {
    if (map.function != MapFunction::file)
        return nullptr;
    const auto known =
        std::find_if(images_.begin(), images_.end(), [&](const auto& one) { return one.first == map.path; });
    const auto kept =
        known != images_.end() ? known->second : std::make_shared<const HeightImage>(read_height_image(map.path));
    if (known == images_.end())
        images_.emplace_front(map.path, kept);
    if (images_.size() > kImages)
        images_.pop_back();
    if (!map.sha256.empty() && map.sha256 != kept->sha256)
        throw UsageError(fmt::format("{} is not the file that the scene means: its SHA-256 is {}, the scene says {}",
                                     map.file, kept->sha256, map.sha256));
    map.sha256 = kept->sha256;
    return kept;
}

PreparedCase CasePreparation::prepare(const Case& one) {
    PreparedCase prepared;
    prepared.one = one;
    Scene& scene = prepared.one.scene;
    if (scene.surface.kind == SurfaceKind::height_map)
        prepared.images.map = image(scene.surface.map);
    if (scene.texture)
        prepared.images.texture = image(scene.texture->map);
    prepared.scene = resolved_toml(prepared.one);
    return prepared;
}

} // namespace forceshade
