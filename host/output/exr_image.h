// An EXR file read block by block through OpenEXRCore, every block checked against what the header says it holds; only
// for .cpp files that use OpenEXR.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <openexr.h>

#include "host/output/exr_volume.h"
#include "host/output/files.h"
#include "host/output/rows.h"

namespace forceshade::exr {

struct Channel {
    std::string name;
    exr_pixel_type_t type = EXR_PIXEL_FLOAT;
    std::int32_t x_sampling = 1, y_sampling = 1; /* every how many pixels there is a value */

    std::size_t bytes() const { return type == EXR_PIXEL_HALF ? 2 : 4; } /* of a value */
};

/// A part as its header announces it.
struct Layer {
    std::string name; /* empty where it has none */
    bool tiled = false;
    exr_compression_t compression = EXR_COMPRESSION_NONE;
    exr_attr_box2i_t data{}, display{}; /* windows: the first and the last pixel */
    std::vector<Channel> channels;      /* as in the file */

    std::uint64_t columns() const { return extent(data.min.x, data.max.x); } /* of the data window */
    std::uint64_t rows() const { return extent(data.min.y, data.max.y); }
    static std::uint64_t extent(std::int32_t first, std::int32_t last) {
        return static_cast<std::uint64_t>(std::int64_t{last} - first + 1);
    }
    std::optional<std::size_t> find(const std::string& channel) const;
    /// OpenEXRCore 3.1 reads B44 wrongly and DWA not at all.
    bool is_supported() const { return compression <= EXR_COMPRESSION_PXR24; }
};

inline constexpr const char* kUnsupported = "its compression is B44 or DWA, which are not read: save it with ZIP";

/// The values of a row of a block, channel by channel in the layer's order; none of a channel that sub-sampling leaves
/// out of this row.
struct Line {
    std::int32_t x = 0, y = 0; /* of its first pixel */
    std::vector<std::span<const std::byte>> values;
};

/// Every method throws IoError `cannot read NAME: ...` for a file that is cut off, damaged or no EXR; a block that
/// holds less than it should is damaged. Memory is that of one block, and a file of few bytes has no large
/// blocks.
class Image {
public:
    /// `name` is what messages call the file. Deep images are refused.
    Image(const ReadableFile& file, std::filesystem::path name);
    ~Image();

    const std::vector<Layer>& layers() const noexcept { return layers_; }
    /// Attributes of the first part; empty where it lacks one of that name and type.
    std::optional<std::string> text(const char* name) const;
    std::optional<exr_attr_v3d_t> vector(const char* name) const;
    std::optional<exr_attr_v3i_t> integers(const char* name) const;

    /// Hands over the lines from row `first` to row `last` of a layer, and others of the same blocks. The block that
    /// was read last is kept, so that rows may be read one by one.
    void read(std::size_t layer, std::int32_t first, std::int32_t last, const std::function<void(const Line&)>& take);

    [[noreturn]] void damaged(const std::string& what) const;

private:
    class Decoder;
    struct Context;

    template <typename Value, typename Get> std::optional<Value> attribute(const char* name, const Get& get) const;
    Layer layer_of(int part) const;
    void check_blocks(int part, const Layer& layer) const;

    const ReadableFile& file_;
    std::filesystem::path name_;
    std::unique_ptr<Context> context_;
    std::vector<Layer> layers_;
    std::unique_ptr<Decoder> decoder_; // before the context is gone
};

// How volumes are laid out in an EXR's parts, for what writes them and what reads them.

/// In the order of Compression; of the same numbers in OpenEXR's other library.
inline constexpr std::array kCompressions{EXR_COMPRESSION_NONE, EXR_COMPRESSION_ZIPS, EXR_COMPRESSION_ZIP,
                                          EXR_COMPRESSION_PXR24};

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

/// Packs the blocks of a part as OpenEXR does, byte for byte. Threads may share it.
class BlockPacker {
public:
    /// Memory of a thread.
    struct Scratch {
        std::vector<std::byte> raw, split, ready;
    };
    BlockPacker(const Part& part, std::uint64_t width, Compression compression);
    /// Of a block, but for the last one.
    std::uint64_t rows() const;
    /// `rows`, some whole ones as they lie in memory, to a block's bytes in the file.
    void pack(std::span<const std::byte> rows, Scratch& scratch, std::vector<std::byte>& packed) const;

private:
    void split_bytes(std::size_t count, Scratch& scratch) const;

    Part part_;
    std::size_t width_;
    Compression compression_;
    std::vector<std::size_t> order_; // of the components in the file
};

/// Throws UsageError if no EXR can hold such a grid.
void require_possible(const VolumeHeader& header);

} // namespace forceshade::exr
