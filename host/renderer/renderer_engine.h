// A renderer of the user's own as an engine: fields, paths and hands of a case by its forces.
#pragma once

#include <memory>

#include "host/field/engine.h"
#include "host/renderer/renderer_process.h"

namespace forceshade {

/// Of a field each voxel is a path of its own. Channels that a renderer does not give follow from its force: the depth
/// by the stiffness, the facet 0 with a force, the proxy where the spring would end; unshaded is the force. Results are
/// the renderer's doubles, rounded. `prepared` must be the case of all work, and outlive it. \throws as
/// RendererProcess.
std::unique_ptr<Engine> make_renderer_engine(const RendererSource& source, const PreparedCase& prepared,
                                             const RendererPatience& patience = {});

} // namespace forceshade
