// A channel's rows as raw little-endian numbers at the file's current position; for the formats without compression.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

#include "host/io/chunk_sink.h"
#include "host/io/temporary_file.h"
#include "host/scene/scene.h"
#include "shaders/shared/layout.h"

namespace forceshade {

static_assert(std::endian::native == std::endian::little, "files are written in memory order");

/// Bytes of one component of a channel.
std::size_t component_bytes(std::uint32_t channel, Precision precision);

/// Writes the chunk's rows of a channel, each repeat_y times, reals converted to `precision`. Throws IoError.
template <typename real>
void write_rows(TemporaryFile& file, const layout::FieldChunk<real>& chunk, std::uint32_t channel, std::size_t repeat_y,
                Precision precision);

/// Flushes, hashes, publishes.
VolumeResult publish_raw(TemporaryFile& file);

} // namespace forceshade
