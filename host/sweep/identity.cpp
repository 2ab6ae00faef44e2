#include "host/sweep/identity.h"

#include <optional>

#include <fmt/format.h>

#include "host/error.h"
#include "host/long_run.h"
#include "host/output/files.h"
#include "host/program.h"

namespace forceshade {

namespace {

class FileDigests {
public:
    /// False if the file cannot be read or is another than the one that is meant.
    bool add_to(FileSpec& spec) {
        auto known = digests_.find(spec.path);
        if (known == digests_.end())
            known = digests_.emplace(spec.path, digest_of(spec.path)).first;
        if (!known->second || (!spec.sha256.empty() && spec.sha256 != *known->second))
            return false;
        spec.sha256 = *known->second;
        return true;
    }

    bool add_to(Scene& scene) {
        const auto image = [&](HeightMapSpec& map) { return map.function != MapFunction::file || add_to(map); };
        return (scene.surface.kind != SurfaceKind::height_map || image(scene.surface.map)) &&
               (scene.surface.kind != SurfaceKind::mesh || add_to(scene.surface.mesh)) &&
               (!scene.texture || image(scene.texture->map)) &&
               (!scene.compare || scene.compare->kind != CompareKind::mesh || add_to(scene.compare->file)) &&
               (!scene.paths || scene.paths->kind != PathKind::recorded || add_to(*scene.paths));
    }

private:
    static std::optional<std::string> digest_of(const std::string& path) {
        try {
            return sha256_of_file(path);
        } catch (const IoError&) {
            return std::nullopt;
        }
    }

    std::map<std::string, std::optional<std::string>> digests_; // by path
};

} // namespace

std::string fingerprint(const std::string& scene, bool cpu_engine) {
    return sha256_of(fmt::format("{}\n{}\n{}", version(), cpu_engine ? "cpu" : "gpu", scene));
}

Fingerprints identify(Study& study) {
    Fingerprints result;
    FileDigests digests;
    for (Case& one : study.cases) {
        check_interrupt();
        if (!digests.add_to(one.scene))
            continue;
        // Which of the two inside = "auto" takes depends on the file, whose digest is in the text.
        std::vector<std::string> scenes{resolved_toml(one)};
        if (one.scene.surface.kind == SurfaceKind::mesh && one.scene.surface.mesh.inside == InsideTest::automatic) {
            scenes.clear();
            for (const InsideTest inside : {InsideTest::pseudonormal, InsideTest::winding}) {
                Case resolved = one;
                set_inside(resolved, inside);
                scenes.push_back(resolved_toml(resolved));
            }
        }
        for (const std::string& scene : scenes)
            for (const bool cpu_engine : {false, true})
                result[one.name].insert(fingerprint(scene, cpu_engine));
    }
    return result;
}

} // namespace forceshade
