// The laws as headers: no library, and no other than GLM. A bump of one facet, shaded by its cylinder (L1, L2); and
// what paths on meshes are made of compiles.
#include <cstdio>

#include "host/reference/contact.h"
#include "host/reference/god_object.h"
#include "host/reference/path_step.h"

namespace layout = forceshade::layout;
namespace reference = forceshade::reference;

template layout::ProxyStart<float> reference::proxy_start(const layout::Law<float>&, reference::Neighbourhood<float>&,
                                                          const reference::Vector<float>&) noexcept;
template reference::LawContact<double> reference::follow(const layout::Law<double>&, reference::GodObject<double>&,
                                                         reference::Neighbourhood<double>&,
                                                         const reference::Vector<double>&,
                                                         const reference::Vector<double>&) noexcept;

int main() {
    layout::Law<double> law{};
    law.features.surface = layout::kSurfaceCylinderBump;
    law.params.stiffness = 1000;        /* N/m */
    law.params.half_width = 0.0127;     /* m */
    law.params.radius = 0.01524;        /* m */
    law.params.centre_depth = 0.008424; /* m */
    const reference::Contact<double> contact = reference::evaluate(law, reference::Vector<double>(0.001, 0, 0.006));
    std::printf("%.9g %.9g %.9g N, depth %.9g m\n", contact.force.x, contact.force.y, contact.force.z, contact.depth);
    return contact.depth > 0 ? 0 : 1;
}
