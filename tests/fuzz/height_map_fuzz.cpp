// A height map, PNG or EXR: read or refused.
#include "host/error.h"
#include "host/output/height_image.h"
#include "host/output/reading.h"
#include "tests/fuzz/fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace forceshade;
    static fuzz::MemoryFile file;
    set_memory_limit(std::uint64_t{16} << 20); // what is announced and not there takes long to fill
    file.write({reinterpret_cast<const char*>(data), size});
    try {
        const HeightImage image = read_height_image(file.path());
        fuzz::require(image.columns > 0 && image.rows > 0 && image.samples.size() == image.columns * image.rows,
                      "{} samples of {} x {}", image.samples.size(), image.columns, image.rows);
        for (const double sample : image.samples)
            fuzz::require(std::isfinite(sample), "a sample is {}", sample);
        fuzz::require(read_height_image(file.path()).samples == image.samples, "read again, samples are others");
    } catch (const Error&) {
    }
    return 0;
}
