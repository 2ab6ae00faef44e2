// Features that a scene does not have itself, to be switched on in it.
#pragma once

#include <memory>

#include "host/prepare/prepared_case.h"

namespace forceshade::study {

/// What such surfaces are shaded by unless the scene says; none where they cannot be.
Shading usual_shading(SurfaceKind kind);

/// As a scene writes it.
const char* name_of(Shading shading);

/// A sine of twelve waves across the scene's feature, a hundredth as high as it is long.
TextureSpec usual_texture(const PreparedCase& prepared, TextureEffect effect);

/// A sine or Gaussian as an image would hold it; `map` becomes one of a file.
std::shared_ptr<const HeightImage> sample_map(HeightMapSpec& map);

} // namespace forceshade::study
