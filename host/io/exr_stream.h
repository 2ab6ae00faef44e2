// OpenEXR's stream into our file, so that what goes wrong is known exactly; only for .cpp files that use OpenEXR.
#pragma once

#include <cstdint>
#include <filesystem>
#include <new>
#include <optional>
#include <string>

#include <ImfIO.h>

#include "host/error.h"
#include "host/io/temporary_file.h"

namespace forceshade::exr {

/// OpenEXR retells some exceptions and swallows those in its destructors, so the first failure is kept here.
class WriteStream final : public Imf::OStream {
public:
    explicit WriteStream(TemporaryFile& file) : Imf::OStream(file.path().c_str()), file_(file) {}
    void write(const char bytes[], int count) override;
    std::uint64_t tellp() override { return file_.tell(); }
    void seekp(std::uint64_t position) override;
    const std::optional<IoError>& failure() const noexcept { return failure_; }

private:
    TemporaryFile& file_;
    std::optional<IoError> failure_;
};

/// Runs `work` and turns what OpenEXR throws into an IoError: the stream's own failure if there is one, else
/// `cannot VERB PATH: what OpenEXR says`. Our own errors pass.
template <typename Stream, typename Work>
decltype(auto) guarded(const Stream& stream, const char* verb, const std::filesystem::path& path, Work&& work) {
    try {
        return work();
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw IoError(std::string("cannot ") + verb + " " + path.string() + ": out of memory");
    } catch (const std::exception& error) {
        if (stream.failure())
            throw IoError(*stream.failure());
        throw IoError(std::string("cannot ") + verb + " " + path.string() + ": " + error.what());
    }
}

} // namespace forceshade::exr
