#include "host/report/sampled_volume.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>

#include <zlib.h>

#include "host/error.h"
#include "host/output/exr_volume.h"
#include "host/prepare/tables.h"
#include "host/scene/study.h"

namespace forceshade::report {
namespace {

std::uint64_t samples(const SampledVolume& volume) {
    return volume.size[0] * volume.size[1] * volume.size[2];
}

// Rows are packed several together, so that nearly all of a plane of constant z must be unpacked for some rows of it:
// of large volumes fewer such planes are read.
constexpr std::uint64_t kMostUnpacked = 256u << 20; /* bytes */

std::uint64_t unpacked(const SampledVolume& volume) {
    const std::uint64_t row = volume.full[0] * 3 * sizeof(float), rows = volume.alike_in_y ? 1 : volume.full[1];
    return row * rows * volume.size[2];
}

// Thins along the longest side until few enough are left.
void choose_strides(SampledVolume& volume, std::uint64_t most) {
    volume.stride = {1, volume.alike_in_y ? volume.full[1] : 1, 1};
    for (;;) {
        for (std::size_t axis = 0; axis < 3; ++axis)
            volume.size[axis] = (volume.full[axis] + volume.stride[axis] - 1) / volume.stride[axis];
        if (unpacked(volume) > kMostUnpacked && volume.size[2] > 1) {
            ++volume.stride[2];
            continue;
        }
        if (samples(volume) <= std::max<std::uint64_t>(most, 1))
            return;
        const auto longest = std::ranges::max_element(volume.size) - volume.size.begin();
        ++volume.stride[static_cast<std::size_t>(longest)];
    }
}

// One y stands for all: of those in the file the others were left out as alike, or it has but one, of a scene that does
// not depend on y.
bool is_alike_in_y(const VolumeHeader& header) {
    if (header.size[1] > 1)
        return header.omitted.find(" y samples, alike") != std::string::npos;
    try { // a file that names no scene tells nothing
        return !header.scene.empty() &&
               !depends_on_y(features_of(parse_scene(header.scene, "the volume's scene").scene));
    } catch (const Error&) {
        return false; // that of another version, or of none: it may depend on y
    }
}

double power_of_two_above(const std::vector<float>& values) {
    float largest = 0;
    for (const float value : values)
        if (std::isfinite(value))
            largest = std::max(largest, std::fabs(value));
    int exponent = 0;
    std::frexp(static_cast<double>(largest), &exponent);
    return largest > 0 ? std::ldexp(1.0, exponent) : 1.0;
}

// Of one component, plane of high bytes first.
void append_planes(std::string& planes, const SampledVolume& volume, std::size_t component, double scale) {
    const std::uint64_t count = samples(volume);
    std::string low;
    std::uint16_t before = 0;
    for (std::uint64_t i = 0; i < count; ++i) {
        const auto value = static_cast<double>(volume.force[3 * i + component]);
        const std::uint16_t half = half_of(static_cast<float>(value / scale));
        if (i % volume.size[0] == 0)
            before = 0;
        const auto step = static_cast<std::uint16_t>(half - before);
        planes += static_cast<char>(step >> 8);
        low += static_cast<char>(step & 0xFF);
        before = half;
    }
    planes += low;
}

std::string compressed(const std::string& bytes) {
    uLongf length = compressBound(bytes.size());
    std::string result(length, '\0');
    const int status = compress2(reinterpret_cast<Bytef*>(result.data()), &length,
                                 reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(), Z_BEST_COMPRESSION);
    if (status != Z_OK)
        throw std::runtime_error("zlib cannot compress");
    result.resize(length);
    return result;
}

} // namespace

SampledVolume sample_volume(const std::filesystem::path& path, std::uint64_t most) {
    VolumeReader reader(path);
    const VolumeHeader& header = reader.header();
    SampledVolume volume;
    volume.full = header.size;
    volume.origin = header.origin;
    volume.spacing = header.spacing;
    volume.alike_in_y = is_alike_in_y(header);
    volume.scene = header.scene;
    choose_strides(volume, most);
    volume.force.reserve(3 * samples(volume));
    std::vector<float> row;
    for (std::uint64_t z = 0; z < volume.full[2]; z += volume.stride[2])
        for (std::uint64_t y = 0; y < volume.full[1]; y += volume.stride[1]) {
            reader.read(layout::kChannelForce, z * volume.full[1] + y, 1, row);
            for (std::uint64_t x = 0; x < volume.full[0]; x += volume.stride[0])
                for (std::size_t component = 0; component < 3; ++component)
                    volume.force.push_back(row[3 * x + component]);
        }
    return volume;
}

PackedForce pack_force(const SampledVolume& volume) {
    PackedForce packed;
    packed.scale = power_of_two_above(volume.force);
    std::string planes;
    for (std::size_t component = 0; component < 3; ++component)
        append_planes(planes, volume, component, packed.scale);
    packed.bytes = compressed(planes);
    return packed;
}

std::uint16_t half_of(float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    const auto sign = static_cast<std::uint16_t>(bits >> 16 & 0x8000u);
    const float size = std::fabs(value);
    if (std::isnan(value))
        return static_cast<std::uint16_t>(sign | 0x7E00u);
    if (size >= 65520.0f)
        return static_cast<std::uint16_t>(sign | 0x7C00u);
    // Of what the last place is worth here there are `count`, rounded to nearest even as the mode is by default; an
    // overflow of the mantissa steps into the exponent, as it should.
    const int exponent = size < 0x1p-14f ? -14 : std::ilogb(size);
    const auto count = static_cast<std::uint32_t>(std::lrint(std::ldexp(size, 10 - exponent)));
    const std::uint32_t low = static_cast<std::uint32_t>(exponent + 14) << 10;
    return static_cast<std::uint16_t>(sign | (low + count));
}

} // namespace forceshade::report
