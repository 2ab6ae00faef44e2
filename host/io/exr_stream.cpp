#include "host/io/exr_stream.h"

#include <algorithm>
#include <cstring>

#include <Iex.h>
#include <fmt/core.h>

namespace forceshade::exr {

void WriteStream::write(const char bytes[], int count) {
    try {
        file_.write(std::string_view(bytes, static_cast<std::size_t>(count)));
    } catch (const IoError& error) {
        failure_ = failure_ ? failure_ : error;
        throw Iex::IoExc(error.what()); // OpenEXR cleans up only after its own kind
    }
}

void WriteStream::seekp(std::uint64_t position) {
    try {
        file_.seek(position);
    } catch (const IoError& error) {
        failure_ = failure_ ? failure_ : error;
        throw Iex::IoExc(error.what());
    }
}

ReadStream::ReadStream(const ReadableFile& file, const std::filesystem::path& name)
    : Imf::IStream(name.c_str()), file_(file) {}

void ReadStream::fail(const IoError& error) {
    failure_ = failure_ ? failure_ : error;
    throw Iex::InputExc(error.what());
}

void ReadStream::fill() {
    constexpr std::size_t kBufferBytes = 1 << 18;
    buffer_.resize(kBufferBytes);
    buffer_position_ = position_;
    try {
        buffer_.resize(file_.read_some(position_, buffer_));
    } catch (const IoError& error) {
        buffer_.clear();
        fail(error);
    }
}

bool ReadStream::read(char bytes[], int count) {
    if (count < 0 || position_ > file_.size() || static_cast<std::uint64_t>(count) > file_.size() - position_)
        fail(IoError(fmt::format("cannot read {}: it ends too soon, or its contents are damaged", fileName())));
    auto wanted = static_cast<std::size_t>(count);
    while (wanted > 0) {
        if (position_ < buffer_position_ || position_ >= buffer_position_ + buffer_.size())
            fill();
        if (buffer_.empty())
            fail(IoError(fmt::format("cannot read {}: it was cut short meanwhile", fileName())));
        const auto offset = static_cast<std::size_t>(position_ - buffer_position_);
        const std::size_t part = std::min(wanted, buffer_.size() - offset);
        std::memcpy(bytes, buffer_.data() + offset, part);
        bytes += part;
        wanted -= part;
        position_ += part;
    }
    return position_ < file_.size();
}

} // namespace forceshade::exr
