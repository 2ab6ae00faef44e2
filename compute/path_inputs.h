// What a kernel of paths reads: the tables of a law and of a batch of paths, on the device. For compute/*.cpp only.
#pragma once

#include "compute/input_buffers.h"
#include "shaders/shared/layout.h"

namespace forceshade::compute {

/// What the hands' devices do to positions and forces.
struct HandFeatures {
    bool friction = false;  /* some device has Coulomb friction */
    bool quantised = false; /* some device rounds positions */
};
template <typename T> HandFeatures features_of(std::span<const layout::HandParams<T>> hands);

/// A batch's harmonics as the kernel reads them: component, axis, path, the last fastest.
template <typename T> std::vector<layout::Harmonic<T>> harmonics_of(const layout::PathBatch<T>& batch);

/// The hands of a batch: one for all, or one a path; of an open loop one that does nothing.
template <typename T>
std::span<const layout::HandParams<T>> hands_of(const layout::PathInput<T>& input, const layout::PathBatch<T>& batch);

/// What a batch moves by, one a path; of recorded paths one that does nothing, for all.
template <typename T> std::span<const layout::MotionParams<T>> motions_of(const layout::PathBatch<T>& batch);

class PathInputs {
public:
    explicit PathInputs(Device::Implementation& device) : buffers_(device, layout::kPathBindRecorded) {}

    /// The law's tables. Buffers are kept and grow. \throws DeviceError (out_of_memory) for a table beyond the device's
    /// range.
    template <typename T> void upload(const layout::Law<T>& law);

    /// A batch's tables; the device must be done with those of the last.
    template <typename T> void upload(const layout::PathInput<T>& input, const layout::PathBatch<T>& batch);

    /// The buffer of a binding below layout::kPathBindRecorded; a small one where the scene has none.
    vk::Buffer buffer(layout::uint binding) const { return buffers_.buffer(binding); }

    /// Bytes copied so far.
    std::uint64_t uploaded() const { return buffers_.uploaded(); }

private:
    InputBuffers buffers_;
};

} // namespace forceshade::compute
