#include "compute/path_inputs.h"

#include <algorithm>

namespace forceshade::compute {

template <typename T> HandFeatures features_of(std::span<const layout::HandParams<T>> hands) {
    using Hand = layout::HandParams<T>;
    return {std::ranges::any_of(hands, [](const Hand& hand) { return hand.coulomb > T(0); }),
            std::ranges::any_of(hands, [](const Hand& hand) { return hand.quantum > T(0); })};
}

template <typename T> std::vector<layout::Harmonic<T>> harmonics_of(const layout::PathBatch<T>& batch) {
    std::vector<layout::Harmonic<T>> harmonics;
    harmonics.reserve(batch.amplitudes.size());
    for (std::size_t i = 0; i < batch.amplitudes.size(); ++i)
        harmonics.push_back({batch.amplitudes[i], batch.phases[i], batch.phase_steps[i]});
    return harmonics;
}

template <typename T>
std::span<const layout::HandParams<T>> hands_of(const layout::PathInput<T>& input, const layout::PathBatch<T>& batch) {
    static constexpr layout::HandParams<T> kNone{};
    if (input.hands.empty())
        return {&kNone, 1};
    return input.hands.size() == 1 ? input.hands : input.hands.subspan(batch.first, batch.count);
}

template <typename T> std::span<const layout::MotionParams<T>> motions_of(const layout::PathBatch<T>& batch) {
    static constexpr layout::MotionParams<T> kNone{};
    return batch.motions.empty() ? std::span<const layout::MotionParams<T>>(&kNone, 1) : batch.motions;
}

template <typename T> void PathInputs::upload(const layout::Law<T>& law) {
    buffers_.upload(layout::kPathBindLaw, std::as_bytes(std::span(&law.params, 1)));
    buffers_.upload(layout::kPathBindFacetVertices, std::as_bytes(law.facet_vertices));
    buffers_.upload(layout::kPathBindMapGradients, std::as_bytes(law.map_gradients));
    buffers_.upload(layout::kPathBindTextureGradients, std::as_bytes(law.texture_gradients));
}

template <typename T> void PathInputs::upload(const layout::PathInput<T>& input, const layout::PathBatch<T>& batch) {
    const std::vector<layout::Harmonic<T>> harmonics = harmonics_of(batch);
    buffers_.upload(layout::kPathBindMotions, std::as_bytes(motions_of(batch)));
    buffers_.upload(layout::kPathBindHarmonics, std::as_bytes(std::span<const layout::Harmonic<T>>(harmonics)));
    buffers_.upload(layout::kPathBindHands, std::as_bytes(hands_of(input, batch)));
    buffers_.upload(layout::kPathBindLengths, std::as_bytes(batch.steps));
}

template HandFeatures features_of<float>(std::span<const layout::HandParams<float>>);
template HandFeatures features_of<double>(std::span<const layout::HandParams<double>>);
template std::vector<layout::Harmonic<float>> harmonics_of<float>(const layout::PathBatch<float>&);
template std::vector<layout::Harmonic<double>> harmonics_of<double>(const layout::PathBatch<double>&);
template std::span<const layout::HandParams<float>> hands_of<float>(const layout::PathInput<float>&,
                                                                    const layout::PathBatch<float>&);
template std::span<const layout::HandParams<double>> hands_of<double>(const layout::PathInput<double>&,
                                                                      const layout::PathBatch<double>&);
template std::span<const layout::MotionParams<float>> motions_of<float>(const layout::PathBatch<float>&);
template std::span<const layout::MotionParams<double>> motions_of<double>(const layout::PathBatch<double>&);
template void PathInputs::upload<float>(const layout::Law<float>&);
template void PathInputs::upload<double>(const layout::Law<double>&);
template void PathInputs::upload<float>(const layout::PathInput<float>&, const layout::PathBatch<float>&);
template void PathInputs::upload<double>(const layout::PathInput<double>&, const layout::PathBatch<double>&);

} // namespace forceshade::compute
