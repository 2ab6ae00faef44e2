#include "host/io/exr_stream.h"

#include <Iex.h>

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

} // namespace forceshade::exr
