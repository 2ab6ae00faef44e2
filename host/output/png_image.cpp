#include <csetjmp>
#include <span>
#include <string>
#include <vector>

#include <png.h>

#include "host/error.h"
#include "host/output/files.h"
#include "host/output/height_image.h"

namespace forceshade {
namespace {

class PngDecoder {
public:
    explicit PngDecoder(const ReadableFile& file) : file_(file) {
        png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, on_error, on_warning);
        info_ = png_ ? png_create_info_struct(png_) : nullptr;
        if (!info_) {
            png_destroy_read_struct(&png_, nullptr, nullptr);
            throw std::bad_alloc();
        }
        png_set_read_fn(png_, this, on_read);
        png_set_user_limits(png_, PNG_UINT_31_MAX,
                            PNG_UINT_31_MAX); // the product is limited before anything is allocated
        // Texts, colour profiles and the like are skipped: libpng would allocate what they say they are, or unpack to.
        png_set_keep_unknown_chunks(png_, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
    }
    ~PngDecoder() { png_destroy_read_struct(&png_, &info_, nullptr); }
    PngDecoder(const PngDecoder&) = delete;
    PngDecoder& operator=(const PngDecoder&) = delete;

    HeightImage decode();

private:
    /// libpng reports errors by a long jump. It only ever jumps back to here, so `work` holds no object that would have
    /// to be destroyed; all memory belongs to this object.
    template <typename Work> void guard(const Work& work) {
        if (setjmp(png_jmpbuf(png_)) != 0)
            throw IoError("cannot read {}: no valid PNG file, {}", file_.path().string(), message_);
        work();
    }
    void start();
    void convert_row(std::span<const png_byte> row, std::size_t y, std::span<double> samples) const;
    double component(std::span<const png_byte> row, std::size_t index) const;

    [[noreturn]] static void on_error(png_structp png, png_const_charp message) {
        auto* self = static_cast<PngDecoder*>(png_get_error_ptr(png));
        std::strncpy(self->message_, message, sizeof self->message_ - 1);
        png_longjmp(png, 1);
    }
    static void on_warning(png_structp, png_const_charp) {}
    static void on_read(png_structp png, png_bytep bytes, std::size_t count);
    std::size_t try_read(png_bytep bytes, std::size_t count) noexcept;

    const ReadableFile& file_;
    std::uint64_t position_ = 0;
    png_structp png_ = nullptr;
    png_infop info_ = nullptr;
    int depth_ = 0, passes_ = 1;
    std::size_t components_ = 1;
    char message_[160] = {};
};

std::size_t PngDecoder::try_read(png_bytep bytes, std::size_t count) noexcept {
    try {
        const std::size_t got = file_.read_some(position_, std::as_writable_bytes(std::span(bytes, count)));
        position_ += got;
        return got;
    } catch (const IoError&) { // no exception may cross libpng's frames
        return 0;
    }
}

void PngDecoder::on_read(png_structp png, png_bytep bytes, std::size_t count) {
    if (static_cast<PngDecoder*>(png_get_io_ptr(png))->try_read(bytes, count) != count)
        png_error(png, "it ends too soon or cannot be read");
}

// No gamma is applied: samples stay the fractions of full scale that they are.
void PngDecoder::start() {
    const int colour = png_get_color_type(png_, info_);
    if (colour == PNG_COLOR_TYPE_PALETTE)
        png_set_palette_to_rgb(png_);
    else if (colour == PNG_COLOR_TYPE_GRAY && png_get_bit_depth(png_, info_) < 8)
        png_set_expand_gray_1_2_4_to_8(png_); // times 255, 85 or 17: exact fractions
    if (colour & PNG_COLOR_MASK_ALPHA)
        png_set_strip_alpha(png_);
    passes_ = png_set_interlace_handling(png_);
    png_read_update_info(png_, info_);
    components_ = png_get_channels(png_, info_);
    depth_ = png_get_bit_depth(png_, info_);
}

double PngDecoder::component(std::span<const png_byte> row, std::size_t index) const {
    if (depth_ == 16)
        return (row[2 * index] * 256 + row[2 * index + 1]) / 65535.0;
    return row[index] / 255.0;
}

void PngDecoder::convert_row(std::span<const png_byte> row, std::size_t y, std::span<double> samples) const {
    for (std::size_t x = 0; x < samples.size(); ++x) {
        samples[x] = component(row, x * components_);
        for (std::size_t c = 1; c < components_; ++c)
            if (component(row, x * components_ + c) != samples[x])
                throw UsageError("{}: the pixel in row {}, column {} is coloured: a height map must be "
                                 "grey (red, green and blue alike)",
                                 file_.path().string(), y, x);
    }
}

HeightImage PngDecoder::decode() {
    guard([this] { png_read_info(png_, info_); });
    const png_uint_32 width = png_get_image_width(png_, info_), height = png_get_image_height(png_, info_);
    require_height_size(file_, width, height);
    constexpr std::uint64_t kMostDeflation = 1040; // deflate shrinks by 1032 at most
    if (std::uint64_t{width} * height / 8 > file_.size() * kMostDeflation)
        throw IoError("cannot read {}: it is too short for {} x {} samples", file_.path().string(), width, height);
    guard([this] { start(); });
    HeightImage image;
    image.columns = width;
    image.rows = height;
    const std::size_t stride = png_get_rowbytes(png_, info_);
    std::vector<png_byte> bytes(stride * (passes_ > 1 ? height : 1));
    const auto row = [&](std::size_t y) { return bytes.data() + (passes_ > 1 ? y * stride : 0); };
    const auto read_row = [&](std::size_t y) { png_read_row(png_, row(y), nullptr); };
    for (int pass = 0; pass + 1 < passes_; ++pass) // an interlaced image grows in memory, pass by pass
        for (std::size_t y = 0; y < image.rows; ++y)
            guard([&] { read_row(y); });
    image.samples.resize(image.columns * image.rows);
    for (std::size_t y = 0; y < image.rows; ++y) {
        guard([&] { read_row(y); });
        convert_row({row(y), stride}, y, std::span(image.samples).subspan(y * image.columns, image.columns));
    }
    guard([this] { png_read_end(png_, nullptr); }); // so that a file whose end is missing is noticed
    return image;
}

} // namespace

HeightImage read_height_png(const ReadableFile& file) {
    return PngDecoder(file).decode();
}

} // namespace forceshade
