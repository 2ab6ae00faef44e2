#include "host/mesh/beam.h"

#include <cstring>

#include "host/reference/wide.h"

namespace forceshade {

using Real3 = reference::Vector<float>;

namespace {

constexpr std::size_t kLanes = 8;
using Reals = float __attribute__((vector_size(32)));
using Whole = std::int32_t __attribute__((vector_size(32)));

} // namespace

static_assert(BeamSections::kSlices == kLanes);

FS_WIDE unsigned find_sections(const BeamRays& rays, float gone, float margin, const std::array<int, 2>& low,
                               const std::array<int, 2>& high, BeamSections& sections) {
    constexpr float kFar = 1e9f; // samples
    const Reals slices = Reals{0, 1, 2, 3, 4, 5, 6, 7} + gone, far = Reals{} + kFar;
    Whole some = Whole{} - 1;
    for (std::size_t side = 0; side < 2; ++side) {
        const auto& at = rays.at[side];
        const auto& step = rays.step[side];
        Reals least = at[0] + step[0] * slices, most = least;
        for (std::size_t i = 1; i < 4; ++i) {
            const Reals place = at[i] + step[i] * slices;
            least = least < place ? least : place;
            most = most > place ? most : place;
        }
        least -= margin;
        most += margin;
        least = least < far ? least : far;
        most = most < far ? most : far;
        least = least > -far ? least : -far;
        most = most > -far ? most : -far;
        // Towards 0: at worst one sample more than there is.
        const Whole below = __builtin_convertvector(least, Whole), end = __builtin_convertvector(most, Whole);
        const Whole first = below - (__builtin_convertvector(below, Reals) < least);
        const Whole low_sample = Whole{} + low[side], high_sample = Whole{} + high[side];
        const Whole from = first > low_sample ? first : low_sample, to = end < high_sample ? end : high_sample;
        std::memcpy(sections.first[side].data(), &from, sizeof from);
        std::memcpy(sections.last[side].data(), &to, sizeof to);
        some &= from <= to;
    }
    unsigned bits = 0;
    for (std::size_t k = 0; k < kLanes; ++k)
        bits |= static_cast<unsigned>(some[k]) & 1u << k;
    return bits;
}

namespace {

// Whole vectors; what stands behind a run's end is measured too.
FS_INLINE std::size_t padded(std::size_t count) {
    return (count + kLanes - 1) / kLanes * kLanes;
}

} // namespace

FS_WIDE void measure_face(const SweptFace& face, SampleRun& run) {
    const Real3 normal = face.triangle.normal, a = face.triangle.corners[0], b = face.triangle.corners[1],
                c = face.triangle.corners[2], out_a = face.sides[0], out_b = face.sides[1], out_c = face.sides[2];
    const std::size_t count = padded(run.count);
    for (std::size_t i = 0; i < count; ++i) {
        const float x = run.x[i], y = run.y[i], z = run.z[i];
        const float height = normal.x * (a.x - x) + normal.y * (a.y - y) + normal.z * (a.z - z);
        const float beyond_a = out_a.x * (x - a.x) + out_a.y * (y - a.y) + out_a.z * (z - a.z);
        const float beyond_b = out_b.x * (x - b.x) + out_b.y * (y - b.y) + out_b.z * (z - b.z);
        const float beyond_c = out_c.x * (x - c.x) + out_c.y * (y - c.y) + out_c.z * (z - c.z);
        const float beyond_ab = beyond_a > beyond_b ? beyond_a : beyond_b;
        run.beyond[i] = beyond_ab > beyond_c ? beyond_ab : beyond_c;
        run.square[i] = height * height;
    }
}

FS_WIDE void measure_edge(const SweptEdge& edge, SampleRun& run) {
    const Real3 start = edge.start, along = edge.along;
    const float per_square = edge.per_square;
    const std::size_t count = padded(run.count);
    for (std::size_t i = 0; i < count; ++i) {
        const float x = run.x[i] - start.x, y = run.y[i] - start.y, z = run.z[i] - start.z;
        float share = (x * along.x + y * along.y + z * along.z) * per_square;
        share = share > 0.0f ? share : 0.0f;
        share = share < 1.0f ? share : 1.0f;
        const float dx = x - share * along.x, dy = y - share * along.y, dz = z - share * along.z;
        run.square[i] = dx * dx + dy * dy + dz * dz;
        run.beyond[i] = 0;
    }
}

FS_WIDE void measure_corner(const SweptCorner& corner, SampleRun& run) {
    const Real3 place = corner.place;
    const std::size_t count = padded(run.count);
    for (std::size_t i = 0; i < count; ++i) {
        const float x = run.x[i] - place.x, y = run.y[i] - place.y, z = run.z[i] - place.z;
        run.square[i] = x * x + y * y + z * z;
        run.beyond[i] = 0;
    }
}

void SweptFace::measure(SampleRun& run) const {
    measure_face(*this, run);
}
void SweptEdge::measure(SampleRun& run) const {
    measure_edge(*this, run);
}
void SweptCorner::measure(SampleRun& run) const {
    measure_corner(*this, run);
}

} // namespace forceshade
