// A case with the images that it names: everything its evaluation needs.
#pragma once

#include <deque>

#include "host/field/tables.h"
#include "host/scene/study.h"

namespace forceshade {

struct PreparedCase {
    Case one; // with the images' SHA-256 filled in
    SceneImages images;
    std::string scene; /* resolved TOML, as it goes into files */
};

/// Reads images; cases that follow each other share them, and only the last few stay in memory.
class CasePreparation {
public:
    /// \throws IoError for an image that is missing or damaged, UsageError for one that is no height map or not the one
    /// whose SHA-256 the scene states.
    PreparedCase prepare(const Case& one);

private:
    std::shared_ptr<const HeightImage> image(HeightMapSpec& map);
    std::deque<std::pair<std::string, std::shared_ptr<const HeightImage>>> images_; // path and image, the newest first
};

} // namespace forceshade
