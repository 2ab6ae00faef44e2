// What kernels read of a mesh under a law; nothing else of it goes to the device.
#pragma once

#include "shaders/shared/layout.h"

namespace forceshade::compute {

/// L7 interpolates the normals of the vertices round a facet: without it neither these nor places nor corners are read.
inline bool reads_corners(const layout::Features& features) {
    return features.shading != layout::kShadingNone;
}

/// L7 starts from the facet's normal; L8 and L9 need its plane.
inline bool reads_facet_normals(const layout::Features& features) {
    return features.shading != layout::kShadingNone || features.map != layout::kMapNone ||
           features.texture != layout::kMapNone;
}

/// Of a field: what lies around a triangle tells the inside, unless the winding number does.
inline bool reads_pseudonormals(const layout::Features& features) {
    return features.inside == layout::kInsidePseudonormal;
}

} // namespace forceshade::compute
