// The scene as a run's precision holds it.
#pragma once

#include "host/scene/scene.h"

namespace forceshade {

/// The scene with its edges and radii rounded to T as a kernel's tables round them, so that a referee of the rounded
/// scene puts a voxel of rounded position on the same side of every edge as a kernel without error does. A voxel
/// exactly on an edge in T has a force that need not occur anywhere in the scene as written: two edges that coincide,
/// one closed and one open, or a half-open facet beside an open cylinder.
template <typename T> Scene held_scene(const Scene& scene);

extern template Scene held_scene<float>(const Scene&);
extern template Scene held_scene<double>(const Scene&);

} // namespace forceshade
