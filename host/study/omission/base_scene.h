// The scenes whose features the study switches on and off.
#pragma once

#include <string>
#include <vector>

#include "host/prepare/prepared_case.h"

namespace forceshade::study {

/// A scene as it stands, each of whose features is then switched alone.
struct BaseScene {
    std::string name;  /* a word: "bump" */
    std::string about; /* for readers, a sentence's end: "a bump of three facets, ..." */
    PreparedCase prepared;
    bool field = true;  /* features of its field are switched */
    bool paths = false; /* likewise of its paths */
    bool given = false; /* by the user: of its surface nothing is known beforehand */
};

/// A bump, a height map, a mesh, and strokes over a bump; small ones for a quick study.
std::vector<BaseScene> own_scenes(bool quick);

/// The user's scene, its grid and paths thinned out to what can be measured in a while. \throws UsageError for a scene
/// with recorded paths alone.
BaseScene user_scene(const PreparedCase& prepared, bool quick);

} // namespace forceshade::study
