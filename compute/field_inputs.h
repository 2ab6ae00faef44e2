// What the field kernel reads: the law, the axes and the tables of a scene, on the device. For compute/*.cpp only.
#pragma once

#include "compute/input_buffers.h"
#include "shaders/shared/layout.h"

namespace forceshade::compute {

class FieldInputs {
public:
    explicit FieldInputs(Device::Implementation& device) : buffers_(device, layout::kBindStatus) {}

    /// Uploads everything a field reads; rows of the x axis are padded with their last sample to a multiple of
    /// `abreast`. Buffers are kept from field to field and grow. \throws DeviceError (out_of_memory) for a table beyond
    /// the device's range.
    template <typename T> void upload(const layout::FieldInput<T>& input, std::uint32_t abreast);

    /// The buffer of a binding below layout::kBindStatus; a small one where the scene has none.
    vk::Buffer buffer(layout::uint binding) const { return buffers_.buffer(binding); }

    /// Bytes copied so far.
    std::uint64_t uploaded() const { return buffers_.uploaded(); }

private:
    InputBuffers buffers_;
};

} // namespace forceshade::compute
