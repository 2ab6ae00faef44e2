#include "host/reference/field.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "host/reference/chunks.h"
#include "host/reference/mesh_contact.h"
#include "host/reference/wide.h"

namespace forceshade::reference {
namespace {

using layout::kMeshBlock;
using layout::uint;

constexpr std::size_t kProbes = kMeshBlock * kMeshBlock * kMeshBlock;

/// The samples of a block, of which (z * 2 + y) * 2 + x stands at (x, y, z); at the grid's end one may come twice.
template <typename T> struct BlockProbes {
    std::array<T, 2> x, y, z;

    Vector<T> at(std::size_t i) const noexcept { return {x[i & 1], y[i >> 1 & 1], z[i >> 2]}; }
};

// A number for each sample of a block, and what comparing gives.
template <typename T> struct ProbeLanes;
template <> struct ProbeLanes<float> {
    using Real = float __attribute__((vector_size(32)));
    using Mask = std::int32_t __attribute__((vector_size(32)));
};
template <> struct ProbeLanes<double> {
    using Real = double __attribute__((vector_size(64)));
    using Mask = std::int64_t __attribute__((vector_size(64)));
};

/// Which of some triangles nearest() finds for each sample of a block; to the last bit its squared distances, computed
/// for all samples at once.
template <typename T> class BlockSearch {
    using Real = typename ProbeLanes<T>::Real;
    using Mask = typename ProbeLanes<T>::Mask;
    struct Vectors {
        Real x, y, z;
    };

public:
    FS_INLINE BlockSearch(const layout::MeshView<T>& mesh, const BlockProbes<T>& probes) noexcept : mesh_(mesh) {
        for (std::size_t i = 0; i < kProbes; ++i) {
            probes_.x[i] = probes.x[i & 1];
            probes_.y[i] = probes.y[i >> 1 & 1];
            probes_.z[i] = probes.z[i >> 2];
        }
    }

    FS_INLINE void consider(uint triangle) noexcept {
        const Triangle<T> shape = triangle_at(mesh_, triangle);
        const Vector<T>& normal = shape.normal;
        Vectors corners[3];
        Real corner_squares[3];
        for (std::size_t i = 0; i < 3; ++i) {
            const Vector<T>& corner = shape.corners[i];
            corners[i] = {corner.x - probes_.x, corner.y - probes_.y, corner.z - probes_.z};
            corner_squares[i] = dot(corners[i], corners[i]);
        }
        const bool has_normal = !(normal.x == T(0) && normal.y == T(0) && normal.z == T(0));
        Mask inside = Mask{} - (has_normal ? 1 : 0), within[3];
        Real nearest{};
        std::size_t longest = 0;
        T longest_square = T(0);
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t next = i == 2 ? 0 : i + 1;
            const Vector<T> edge = shape.corners[next] - shape.corners[i];
            const T length_square = reference::dot(edge, edge);
            inside &= dot(corners[i], reference::cross(normal, edge)) <= T(0);
            // As nearest_on_edge().
            const bool backwards = runs_backwards(edge);
            const std::size_t start = backwards ? next : i, end = backwards ? i : next;
            const Vector<T> direction = backwards ? -edge : edge;
            const Vectors& from = corners[start];
            const Real along = -dot(from, direction), share = along / length_square;
            const Vectors offset{from.x + share * direction.x, from.y + share * direction.y,
                                 from.z + share * direction.z};
            const Mask after = along > T(0), before = along < length_square;
            const Real square = after ? (before ? dot(offset, offset) : corner_squares[end]) : corner_squares[start];
            nearest = i == 0 ? square : square < nearest ? square : nearest;
            within[i] = after & before;
            longest = length_square > longest_square ? i : longest;
            longest_square = length_square > longest_square ? length_square : longest_square;
        }
        const Real height = dot(corners[0], normal);
        keep(triangle, (inside & within[longest]) ? height * height : nearest);
    }

    uint winner(std::size_t sample) const noexcept { return static_cast<uint>(winners_[sample]); }

private:
    FS_INLINE static Real dot(const Vectors& u, const Vectors& v) noexcept { return u.x * v.x + u.y * v.y + u.z * v.z; }
    FS_INLINE static Real dot(const Vectors& u, const Vector<T>& v) noexcept {
        return u.x * v.x + u.y * v.y + u.z * v.z;
    }

    FS_INLINE void keep(uint triangle, Real squares) noexcept {
        Mask nearer = squares < best_;
        const Mask equal = squares == best_;
        Mask any = equal;
        for (std::size_t half = kProbes / 2; half > 0; half /= 2)
            for (std::size_t i = 0; i < half; ++i)
                any[i] |= any[i + half];
        if (any[0])
            for (std::size_t i = 0; i < kProbes; ++i)
                if (equal[i] && comes_before(mesh_, triangle, winner(i)))
                    nearer[i] = -1;
        best_ = nearer ? squares : best_;
        winners_ = nearer ? Mask{} + static_cast<std::int32_t>(triangle) : winners_;
    }

    const layout::MeshView<T>& mesh_;
    Vectors probes_;
    Real best_ = Real{} + std::numeric_limits<T>::infinity();
    Mask winners_{};
};

using BlockTriangles = std::array<uint, kProbes>;

template <typename T>
FS_INLINE BlockTriangles search(const layout::MeshView<T>& mesh, const BlockProbes<T>& probes,
                                std::span<const uint> candidates) noexcept {
    BlockSearch<T> block(mesh, probes);
    for (const uint candidate : candidates)
        block.consider(candidate);
    BlockTriangles triangles;
    for (std::size_t i = 0; i < kProbes; ++i)
        triangles[i] = block.winner(i);
    return triangles;
}

} // namespace

FS_WIDE BlockTriangles nearest_of(const layout::MeshView<float>& mesh, const BlockProbes<float>& probes,
                                  std::span<const uint> candidates) noexcept {
    return search(mesh, probes, candidates);
}

FS_WIDE BlockTriangles nearest_of(const layout::MeshView<double>& mesh, const BlockProbes<double>& probes,
                                  std::span<const uint> candidates) noexcept {
    return search(mesh, probes, candidates);
}

namespace {

/// A chunk of a grid: everything out of contact, then the blocks of a plan.
template <typename T> class MeshChunk {
public:
    MeshChunk(const layout::FieldInput<T>& input, const layout::FieldChunk<T>& chunk, SampleBuffers<T>& buffers)
        : input_(input), chunk_(chunk), buffers_(buffers) {}

    void run(const layout::MeshPlan& plan, std::size_t threads) {
        const auto begin = std::ranges::lower_bound(plan.blocks, chunk_.z_first & ~(kMeshBlock - std::size_t(1)), {},
                                                    &layout::MeshBlock::z);
        const auto end =
            std::ranges::lower_bound(plan.blocks, chunk_.z_first + chunk_.z_count, {}, &layout::MeshBlock::z);
        const auto first = static_cast<std::size_t>(begin - plan.blocks.begin());
        const auto count = static_cast<std::size_t>(end - begin);
        share_out(threads, chunk_.z_count, [&](std::size_t, std::size_t z) { free_layer(z); });
        constexpr std::size_t kRun = 256;
        share_out(threads, (count + kRun - 1) / kRun, [&](std::size_t, std::size_t run) {
            for (std::size_t b = run * kRun; b < std::min(count, (run + 1) * kRun); ++b)
                evaluate(plan, first + b);
        });
    }

private:
    std::size_t sample_at(std::size_t x, std::size_t y, std::size_t z) const noexcept {
        return ((z - chunk_.z_first) * chunk_.y_count + y - chunk_.y_first) * chunk_.x_pitch + x;
    }

    void free_layer(std::size_t layer) {
        const std::size_t samples = chunk_.y_count * chunk_.x_pitch, begin = layer * samples;
        const auto clear = [&](auto& values, std::size_t numbers, auto value) {
            if (!values.empty())
                std::fill_n(values.begin() + static_cast<std::ptrdiff_t>(begin * numbers), samples * numbers, value);
        };
        clear(buffers_.force, 3, T(0));
        clear(buffers_.unshaded, 3, T(0));
        clear(buffers_.depth, 1, T(0));
        clear(buffers_.facet, 1, layout::kNoFacet);
        if (buffers_.proxy.empty())
            return;
        const std::size_t z = chunk_.z_first + layer;
        for (std::size_t y = chunk_.y_first; y < chunk_.y_first + chunk_.y_count; ++y)
            for (std::size_t x = 0; x < chunk_.x_count; ++x)
                SampleBuffers<T>::put(
                    buffers_.proxy, sample_at(x, y, z),
                    to_scene(input_.law.mesh.params, Vector<T>(input_.x[x], input_.y[y], input_.z[z])));
    }

    void evaluate(const layout::MeshPlan& plan, std::size_t index) {
        const layout::MeshBlock& block = plan.blocks[index];
        if (block.y + kMeshBlock <= chunk_.y_first || block.y >= chunk_.y_first + chunk_.y_count)
            return;
        const layout::MeshView<T>& mesh = input_.law.mesh;
        const auto pair = [](std::span<const T> axis, uint first) {
            return std::array{axis[first], axis[std::min<std::size_t>(first + 1, axis.size() - 1)]};
        };
        const BlockProbes<T> probes{pair(input_.x, block.x), pair(input_.y, block.y), pair(input_.z, block.z)};
        const BlockTriangles nearest = nearest_of(mesh, probes, plan.candidates.subspan(block.first, block.count));
        const uint wanted = plan.wanted.empty() ? 0xFFu : plan.wanted[index];
        for (std::size_t i = 0; i < kProbes; ++i) {
            const std::size_t x = block.x + (i & 1), y = block.y + (i >> 1 & 1), z = block.z + (i >> 2);
            if ((wanted >> i & 1u) == 0 || x >= input_.x.size() || y < chunk_.y_first ||
                y >= chunk_.y_first + chunk_.y_count || z < chunk_.z_first || z >= chunk_.z_first + chunk_.z_count)
                continue;
            const Vector<T> probe = probes.at(i);
            const TrianglePoint<T> point = nearest_on_triangle(probe, triangle_at(mesh, nearest[i]));
            const Nearest<T> found{nearest[i], mesh.triangle_facets[nearest[i]], point.feature, point.offset,
                                   point.square};
            if (plan.inside.empty() ? !inside_by_pseudonormal(mesh, found) : (plan.inside[index] >> i & 1u) == 0)
                continue;
            const Contact<T> contact = contact_with(input_.law, found, probe);
            const std::size_t sample = sample_at(x, y, z);
            buffers_.store(sample, contact, contact.force);
            SampleBuffers<T>::put(buffers_.unshaded, sample, contact.unshaded);
        }
    }

    const layout::FieldInput<T>& input_;
    const layout::FieldChunk<T>& chunk_;
    SampleBuffers<T>& buffers_;
};

} // namespace

template <typename T>
void evaluate_mesh_field(const layout::FieldInput<T>& input, const FieldOptions& options, const PlanLayers& plan,
                         const std::function<void(const layout::FieldChunk<T>&)>& consume) {
    constexpr std::size_t kPlannedSamples = std::size_t(1) << 22, kPlannedLayers = 16;
    const layout::uint channels = input.law.features.channels;
    const std::size_t nx = input.x.size(), ny = input.y.size(), nz = input.z.size();
    const std::size_t row_bytes = std::max<std::size_t>(1, nx * SampleBuffers<T>::bytes_per_sample(channels));
    // Layers of whole blocks; of grids so wide that two are too much, rows of one layer.
    const std::size_t rows = std::max<std::size_t>(1, options.chunk_bytes / row_bytes);
    const bool in_layers = 2 * ny <= 4 * rows;
    const std::size_t z_step = in_layers ? std::max<std::size_t>(kMeshBlock, rows / ny / kMeshBlock * kMeshBlock) : 1;
    const std::size_t y_step = in_layers ? ny : std::max<std::size_t>(kMeshBlock, rows / kMeshBlock * kMeshBlock);
    const std::size_t slab = std::max<std::size_t>(1, kPlannedSamples / (nx * ny) / kPlannedLayers) * kPlannedLayers;
    const std::size_t threads = threads_for(options.threads);
    SampleBuffers<T> buffers;
    buffers.resize(channels, nx * std::min(ny, y_step) * std::min(nz, z_step));
    for (std::size_t first = 0; first < nz; first += slab) {
        const std::size_t end = std::min(nz, first + slab);
        const layout::MeshPlan layers = plan(first, end - first);
        for (std::size_t z = first; z < end; z += z_step)
            for (std::size_t y = 0; y < ny; y += y_step) {
                layout::FieldChunk<T> chunk{};
                chunk.x_count = chunk.x_pitch = nx;
                chunk.y_first = y;
                chunk.y_count = std::min(y_step, ny - y);
                chunk.z_first = z;
                chunk.z_count = std::min(z_step, end - z);
                buffers.set_spans(chunk);
                chunk.unshaded = buffers.unshaded;
                MeshChunk<T>(input, chunk, buffers).run(layers, threads);
                consume(chunk);
            }
    }
}

template void evaluate_mesh_field<float>(const layout::FieldInput<float>&, const FieldOptions&, const PlanLayers&,
                                         const std::function<void(const layout::FieldChunk<float>&)>&);
template void evaluate_mesh_field<double>(const layout::FieldInput<double>&, const FieldOptions&, const PlanLayers&,
                                          const std::function<void(const layout::FieldChunk<double>&)>&);

} // namespace forceshade::reference
