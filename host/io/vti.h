// A field as ParaView's ImageData (.vti): raw appended arrays named as the channels, origin and spacing in metres,
// streamed.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>

#include "host/io/chunk_sink.h"
#include "host/scene/scene.h"

namespace forceshade {

struct VtiHeader {
    std::array<std::uint64_t, 3> size{};
    std::array<double, 3> origin{};  /* m */
    std::array<double, 3> spacing{}; /* m */
    std::uint32_t channels = layout::kChannelForce;
    Precision precision = Precision::f32; /* Float32 or Float64 */
};

class VtiWriter final : public ChunkSink {
public:
    /// Throws IoError.
    VtiWriter(const std::filesystem::path& path, const VtiHeader& header);
    ~VtiWriter() override;
    void write(const layout::FieldChunk<float>& chunk, std::size_t repeat_y) override;
    void write(const layout::FieldChunk<double>& chunk, std::size_t repeat_y) override;
    VolumeResult finish() override;

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace forceshade
