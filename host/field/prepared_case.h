// A case with the images that it names: everything its evaluation needs.
#pragma once

#include <deque>

#include "host/field/tables.h"
#include "host/scene/study.h"

namespace forceshade {

struct PreparedCase {
    Case one; // with the files' SHA-256 filled in, and the grid that follows from a mesh
    SceneImages images;
    std::string scene;                 /* resolved TOML, as it goes into files */
    std::vector<std::string> warnings; /* of the mesh's file, for a static field */
};

/// Reads images and meshes; cases that follow each other share them, and only the last few stay in memory.
class CasePreparation {
public:
    /// \throws IoError for a file that is missing or damaged, UsageError for one that is no height map or mesh, or not
    /// the one whose SHA-256 the scene states.
    PreparedCase prepare(const Case& one);

private:
    std::shared_ptr<const HeightImage> image(HeightMapSpec& map);
    std::shared_ptr<const SceneMesh> mesh(MeshSpec& spec);
    std::deque<std::pair<MeshSpec, std::shared_ptr<const SceneMesh>>> meshes_;      // the newest first
    std::deque<std::pair<std::string, std::shared_ptr<const HeightImage>>> images_; // path and image, the newest first
};

} // namespace forceshade
