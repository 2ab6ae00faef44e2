#include "host/scene/study.h"

namespace forceshade {

std::string_view default_study_toml() {
    return R"toml(# The study of Morgenbesser & Srinivasan 1996: seven bumps at three radii, one force-shaded plane among them,
# and the number of facets beyond the paper's three, shaded and unshaded.
[surface]
width = "1000 mil"
radius = ["600 mil", "1000 mil", "1400 mil"]

[force]
stiffness = "1 N/mm"
depth = "vertical"

[grid]
size = [256, 64, 128]
origin = ["-25 mm", "-6 mm", "-10 mm"]
spacing = "0.2 mm"

[[variant]]
surface.kind = "cylinder_bump"

[[variant]]
surface.kind = "bump"
surface.facets = [1, 2, 3]
force.shading = ["none", "reference"]

[[variant]]
surface.kind = "bump"
surface.facets = [4, 8, 16, 32, 64]
force.shading = ["none", "reference"]
)toml";
}

} // namespace forceshade
