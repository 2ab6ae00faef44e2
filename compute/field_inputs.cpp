#include "compute/field_inputs.h"

namespace forceshade::compute {

template <typename T> void FieldInputs::upload(const layout::FieldInput<T>& input, std::uint32_t abreast) {
    std::vector<T> axes(input.x.begin(), input.x.end());
    axes.resize((axes.size() + abreast - 1) / abreast * abreast, input.x.back());
    axes.insert(axes.end(), input.y.begin(), input.y.end());
    axes.insert(axes.end(), input.z.begin(), input.z.end());
    buffers_.upload(layout::kBindLaw, std::as_bytes(std::span(&input.law.params, 1)));
    buffers_.upload(layout::kBindAxes, std::as_bytes(std::span<const T>(axes)));
    buffers_.upload(layout::kBindFacetVertices, std::as_bytes(input.law.facet_vertices));
    buffers_.upload(layout::kBindMapGradients, std::as_bytes(input.law.map_gradients));
    buffers_.upload(layout::kBindTextureGradients, std::as_bytes(input.law.texture_gradients));
}

template void FieldInputs::upload<float>(const layout::FieldInput<float>&, std::uint32_t);
template void FieldInputs::upload<double>(const layout::FieldInput<double>&, std::uint32_t);

} // namespace forceshade::compute
