// Where the rows of an evaluated field go: a file that receives them in order and is published when complete.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "shaders/shared/layout.h"

namespace forceshade {

struct VolumeTimings {
    double encode = 0;    /* s: converting, compressing, handing to the kernel */
    double flush = 0;     /* s: until the disk has it */
    double read_back = 0; /* s: reading, decompressing, comparing */
    double hash = 0;      /* s: SHA-256 of the file */
};

/// What became of a finished file. NPY and VTI files fill in only hash and size.
struct VolumeResult {
    std::string sha256;      /* of the file's bytes */
    std::uint64_t bytes = 0; /* of the file */
    VolumeTimings timings;
    double largest_force = 0;                     /* N: largest |F|, of the values rounded to float */
    std::array<std::uint64_t, 3> largest_voxel{}; /* where it stands first in file order */
    std::uint64_t non_finite = 0;                 /* NaN and infinite values */
};

/// Chunks arrive in row order: row = z * ny + y. A chunk covers whole layers, or rows of one layer. With `repeat_y` > 1
/// (a field that does not depend on y) it holds one row a layer, which stands for repeat_y = ny rows.
/// A sink that is destroyed before finish() leaves no file.
class ChunkSink {
public:
    virtual ~ChunkSink() = default;
    /// Throws IoError; std::logic_error if rows come out of order or a channel is missing.
    virtual void write(const layout::FieldChunk<float>& chunk, std::size_t repeat_y) = 0;
    virtual void write(const layout::FieldChunk<double>& chunk, std::size_t repeat_y) = 0;
    /// After the last row, once. Throws IoError.
    virtual VolumeResult finish() = 0;
};

} // namespace forceshade
