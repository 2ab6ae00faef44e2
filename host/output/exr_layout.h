// How volumes are laid out in an EXR's parts, for what writes them and what reads them; only for .cpp files that use
// OpenEXR.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/output/exr_volume.h"
#include "host/output/rows.h"

namespace forceshade::exr {

/// One part of a volume; its rows in memory are tight, samples interleaved by component.
struct Part {
    std::uint32_t channel = 0;         /* layout::kChannel... */
    std::vector<const char*> channels; /* names in the file, by component */
    const char* unit = "";             /* of the samples */
    PixelFormat format = PixelFormat::float32;

    std::size_t sample_bytes() const { return channels.size() * bytes_of(format); }
};

Part make_part(std::uint32_t channel, PixelType pixel, Compression compression);

/// The parts of a volume in file order.
std::vector<Part> parts_of(const VolumeHeader& header);

/// Throws UsageError if no EXR can hold such a grid.
void require_possible(const VolumeHeader& header);

} // namespace forceshade::exr
