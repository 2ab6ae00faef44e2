// One channel of a field as a NumPy array, shape (nz, ny, nx, 3) for vectors and (nz, ny, nx) for scalars, streamed.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "host/io/chunk_sink.h"
#include "host/scene/scene.h"

namespace forceshade {

/// The bytes before the numbers of an array of a channel.
std::string npy_header(const std::vector<std::uint64_t>& shape, std::uint32_t channel, Precision precision);

class NpyWriter final : public ChunkSink {
public:
    /// `channel` is one layout::kChannel... bit; reals are stored as '<f4' or '<f8', ids as '<u4'. Throws IoError.
    NpyWriter(const std::filesystem::path& path, const std::array<std::uint64_t, 3>& size, std::uint32_t channel,
              Precision precision);
    ~NpyWriter() override;
    void write(const layout::FieldChunk<float>& chunk, std::size_t repeat_y) override;
    void write(const layout::FieldChunk<double>& chunk, std::size_t repeat_y) override;
    VolumeResult finish() override;

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace forceshade
