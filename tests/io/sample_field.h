// Made-up fields for tests of files: every channel, rows pitched as the kernels pitch them, cut into chunks at will.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "host/output/exr_volume.h"
#include "host/output/rows.h"
#include "shaders/shared/law.h"

namespace forceshade::testing {

template <typename real = float> struct SampleField {
    std::array<std::uint64_t, 3> size;
    std::size_t pitch;
    std::vector<real> force, depth, proxy, unshaded;
    std::vector<layout::uint> facet;

    /// Smooth in all directions, or alike along y. Pitch samples hold NaN: no file may contain them.
    explicit SampleField(std::array<std::uint64_t, 3> size_, bool varies_along_y = true)
        : size(size_), pitch((size_[0] + 1) / 2 * 2 + 2) {
        const std::size_t samples = pitch * size[1] * size[2];
        const real padding = std::numeric_limits<real>::quiet_NaN();
        force.assign(samples * 3, padding), proxy = unshaded = force;
        depth.assign(samples, padding);
        facet.assign(samples, 12345);
        for (std::size_t row = 0; row < size[1] * size[2]; ++row)
            for (std::size_t x = 0; x < size[0]; ++x)
                set(row * pitch + x, static_cast<double>(x), varies_along_y ? static_cast<double>(row % size[1]) : 0.0,
                    static_cast<double>(row / size[1]));
    }

    void set(std::size_t sample, double x, double y, double z) {
        for (std::size_t c = 0; c < 3; ++c) {
            const auto phase = static_cast<double>(c);
            force[3 * sample + c] = static_cast<real>(std::sin(0.1 * x + 0.03 * y + phase) * std::cos(0.2 * z));
            proxy[3 * sample + c] = static_cast<real>(1e-3 * (x + 2 * y + 3 * z + phase));
            unshaded[3 * sample + c] = static_cast<real>(std::exp(-0.1 * x) * (y + phase));
        }
        depth[sample] = static_cast<real>(std::max(0.0, 1e-3 * (x - z)));
        facet[sample] = x > z ? static_cast<layout::uint>(x) : layout::kNoFacet;
    }

    std::size_t rows() const { return size[1] * size[2]; }

    /// Rows [first, first + count): whole layers, or rows of one layer.
    layout::FieldChunk<real> chunk(std::size_t first, std::size_t count) const {
        const bool layers = first % size[1] == 0 && count % size[1] == 0;
        layout::FieldChunk<real> cut{};
        cut.x_count = size[0], cut.x_pitch = pitch;
        cut.y_first = first % size[1], cut.y_count = layers ? size[1] : count;
        cut.z_first = first / size[1], cut.z_count = layers ? count / size[1] : 1;
        cut.force = std::span(force).subspan(first * pitch * 3, count * pitch * 3);
        cut.proxy = std::span(proxy).subspan(first * pitch * 3, count * pitch * 3);
        cut.unshaded = std::span(unshaded).subspan(first * pitch * 3, count * pitch * 3);
        cut.depth = std::span(depth).subspan(first * pitch, count * pitch);
        cut.facet = std::span(facet).subspan(first * pitch, count * pitch);
        return cut;
    }

    /// The whole field at once.
    void write_to(ChunkSink& sink) const { sink.write(chunk(0, rows()), 1); }
    /// Pieces of one layer of at most `most` rows each.
    void write_in_pieces(ChunkSink& sink, std::size_t most) const {
        for (std::size_t first = 0; first < rows();) {
            const std::size_t count = std::min(most, size[1] - first % size[1]);
            sink.write(chunk(first, count), 1);
            first += count;
        }
    }
};

/// The samples of a channel without the pitch.
template <typename T>
std::vector<T> tight(const std::vector<T>& pitched, const std::array<std::uint64_t, 3>& size, std::size_t pitch,
                     std::size_t components) {
    std::vector<T> values;
    for (std::size_t row = 0; row < size[1] * size[2]; ++row)
        for (std::size_t i = 0; i < size[0] * components; ++i)
            values.push_back(pitched[row * pitch * components + i]);
    return values;
}

inline constexpr std::uint32_t kAllChannels = 31;

inline constexpr std::array<std::uint64_t, 3> kSampleSize{37, 11, 7};

inline VolumeHeader sample_header(const std::array<std::uint64_t, 3>& size, std::uint32_t channels = kAllChannels) {
    VolumeHeader header;
    header.size = size;
    header.origin = {-0.025, -0.006, -0.01};
    header.spacing = {0.0002, 0.0003, 0.0004};
    header.channels = channels;
    header.scene = "[surface]\nkind = \"bump\"\n";
    header.version = "0.1.0";
    header.omitted = "texture, history";
    return header;
}

} // namespace forceshade::testing
