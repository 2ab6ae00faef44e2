#include "host/mesh/solid_scan.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <tuple>
#include <utility>
#include <vector>

#include "host/mesh/clearance.h"
#include "host/mesh/exact.h"
#include "host/mesh/near_triangles.h"
#include "host/mesh/region_sweep.h"
#include "host/mesh/structure.h"
#include "host/reference/chunks.h"
#include "host/reference/mesh_nearest.h"

namespace forceshade {

namespace {

using glm::dvec3;
using layout::kMeshBlock;
using layout::uint;
using reference::cross;
using reference::dot;
using reference::Vector;

constexpr std::size_t kBlockSamples = kMeshBlock * kMeshBlock * kMeshBlock;
// At once: 8 bytes each, and 16 layers at least. Cells are numbered in 32 bits.
constexpr std::size_t kMostSamples = std::size_t(1) << 23, kLayers = 16, kMostAtAll = std::size_t(1) << 26;
constexpr double kMargin = 5e-3;     // samples: how far sweeps reach beyond their regions
constexpr double kNear = 16;         // times the slack: outside, but so near that the law may find it inside
constexpr double kMostMargin = 0.25; // where slack makes it more, the grid is too fine
constexpr double kMostReach = 1024;  // 1, of the grid: rounding decides what is nearest to samples very far away
constexpr double kMostUneven = 1e-3; // samples: how far a grid's samples are from even
constexpr double kMostTilt = 5e-4;   // of a normal against its triangle: as a squared distance less than slack

// What rounding in single precision makes of a distance d, to first order, u half an epsilon and e the longest edge:
// - of a corner or an edge, whose coordinates are differences no larger than d + e: below 12 u (d + e);
// - of a face the same. Its foot is within 28 u (d + e) of the triangle (see prune_slack()): that is of second order,
//   unless d is about as small, and then all is below 42 u e.
// So 12 u d + 42 u e; twice, of the least distance and of that to the nearest triangle. And in all 8 u, where double
// tables are rounded to single or, in single precision, the law's normals fit its corners to 3.5 u.
template <typename T> DistanceSlack slack_of(float longest) {
    constexpr float u = std::numeric_limits<float>::epsilon() / 2;
    constexpr float kTimes = std::is_same_v<T, float> ? 4 : 2; // by the sweeps, and by the law in single precision
    return {kTimes * 12 * u, kTimes * 42 * u * longest + 8 * u};
}

template <typename T> dvec3 double_at(std::span<const T> table, std::size_t index) {
    return dvec3(reference::vector_at(table, index));
}

// Fills what of the surface depends on its coordinates. False where the law's normals are not those of its triangles.
template <typename T> bool measure(const layout::MeshView<T>& mesh, SweptSurface& surface, double& volume) {
    surface.normals.resize(mesh.triangle_normals.size());
    double longest = 0;
    dvec3 low(std::numeric_limits<double>::infinity()), high = -low;
    volume = 0;
    for (std::size_t t = 0; t < surface.triangles(); ++t) {
        std::array<dvec3, 3> corners;
        for (std::size_t i = 0; i < 3; ++i)
            corners[i] = double_at(mesh.vertices, surface.corners[3 * t + i]);
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = std::min({low[axis], corners[0][axis], corners[1][axis], corners[2][axis]});
            high[axis] = std::max({high[axis], corners[0][axis], corners[1][axis], corners[2][axis]});
        }
        const dvec3 ab = corners[1] - corners[0], ac = corners[2] - corners[0], bc = corners[2] - corners[1];
        dvec3 normal = cross(ab, ac);
        volume += dot(corners[0], normal);
        const double area = std::sqrt(dot(normal, normal));
        normal = normal / area;
        const dvec3 tilt = normal - double_at(mesh.triangle_normals, t);
        if (!(dot(tilt, tilt) < kMostTilt * kMostTilt))
            return false;
        for (int i = 0; i < 3; ++i)
            surface.normals[3 * t + std::size_t(i)] = static_cast<float>(normal[i]);
        longest = std::max({longest, dot(ab, ab), dot(ac, ac), dot(bc, bc)});
    }
    surface.longest = static_cast<float>(std::sqrt(longest));
    // Along any axis, one of both ways leads out within half of the mesh's length.
    const dvec3 extent = high - low;
    surface.deepest = static_cast<float>(std::min({extent.x, extent.y, extent.z}) / 2 + 1e-6);
    return true;
}

void find_stars(SweptSurface& surface) {
    surface.star_begins.assign(surface.count_vertices() + 1, 0);
    for (const uint vertex : surface.corners)
        ++surface.star_begins[vertex + 1];
    for (std::size_t v = 0; v < surface.count_vertices(); ++v)
        surface.star_begins[v + 1] += surface.star_begins[v];
    surface.stars.resize(surface.corners.size());
    std::vector<uint> next(surface.star_begins.begin(), surface.star_begins.end() - 1);
    for (std::size_t corner = 0; corner < surface.corners.size(); ++corner)
        surface.stars[next[surface.corners[corner]]++] = static_cast<uint>(corner);
}

// Of an even axis that does not reach too far, origin and spacing.
template <typename T> bool measure_axis(std::span<const T> axis, double& origin, double& spacing) {
    origin = static_cast<double>(axis.front());
    spacing = axis.size() > 1 ? (static_cast<double>(axis.back()) - origin) / static_cast<double>(axis.size() - 1) : 1;
    for (std::size_t i = 0; i < axis.size(); ++i)
        if (!(std::abs(static_cast<double>(axis[i]) - origin - spacing * static_cast<double>(i)) <=
              kMostUneven * spacing))
            return false;
    return spacing > 0 && std::max(std::abs(axis.front()), std::abs(axis.back())) <= T(kMostReach);
}

// A bit for each sample of the rows along x of a slab, flipped where the surface is crossed from the sample before.
class Crossings {
public:
    Crossings(std::size_t samples, std::size_t rows) : words_(samples / 64 + 1), bits_(words_ * rows, 0) {}

    /// Flips all samples of a row from one on; threads may.
    void flip_from(std::size_t row, std::size_t sample) {
        const std::atomic_ref<std::uint64_t> word(bits_[row * words_ + sample / 64]);
        word.fetch_xor(std::uint64_t(1) << sample % 64, std::memory_order_relaxed);
    }

    /// The row's samples, 64 a word, as they are after all flips: once.
    std::span<const std::uint64_t> settle(std::size_t row) {
        const std::span<std::uint64_t> words(&bits_[row * words_], words_);
        std::uint64_t before = 0;
        for (std::uint64_t& word : words) {
            for (int shift = 1; shift < 64; shift *= 2)
                word ^= word << shift;
            word ^= before;
            before = word >> 63 ? ~std::uint64_t(0) : 0;
        }
        return words;
    }

private:
    std::size_t words_;
    std::vector<std::uint64_t> bits_;
};

// A corner seen along x.
struct Flat {
    double y, z;
};

// Whether b, seen from a, has p to its left; exact, and of points on the line as if p had been moved by next to nothing
// along z, and by far less against y: so that the triangles of an edge, and those of a corner, agree. `a` comes first
// of the two by (y, z).
bool is_left(const Flat& a, const Flat& b, const Flat& p) {
    constexpr double kSure = 1e-15;
    const double left = (b.y - a.y) * (p.z - a.z), right = (b.z - a.z) * (p.y - a.y);
    if (std::abs(left - right) > kSure * (std::abs(left) + std::abs(right)))
        return left > right;
    const bool is_on = (a.y == p.y && a.z == p.z) || (b.y == p.y && b.z == p.z) || (a.y == b.y && a.y == p.y) ||
                       (a.z == b.z && a.z == p.z);
    return is_on || turn_of({a.y, a.z}, {b.y, b.z}, {p.y, p.z}) >= 0;
}

// What blocks of one layer come to.
struct LayerPlan {
    std::vector<layout::MeshBlock> blocks; /* runs of `candidates` */
    std::vector<uint> candidates, wanted;
    std::uint64_t samples = 0;
};

// The ties of each block.
struct BlockTies {
    std::vector<std::uint32_t> begins; /* blocks + 1 */
    std::vector<SweptTie> ties;

    std::span<const SweptTie> of(std::size_t block) const {
        return std::span(ties).subspan(begins[block], begins[block + 1] - begins[block]);
    }
};

BlockTies sorted_by_block(const std::vector<SweptTie>& ties, std::size_t blocks) {
    BlockTies result{std::vector<std::uint32_t>(blocks + 1, 0), std::vector<SweptTie>(ties.size())};
    for (const SweptTie& tie : ties)
        ++result.begins[tie.cell / kBlockSamples + 1];
    for (std::size_t block = 0; block < blocks; ++block)
        result.begins[block + 1] += result.begins[block];
    std::vector<std::uint32_t> next(result.begins.begin(), result.begins.end() - 1);
    for (const SweptTie& tie : ties)
        result.ties[next[tie.cell / kBlockSamples]++] = tie;
    return result;
}

} // namespace

template <typename T> struct SolidScan<T>::Implementation {
    layout::MeshView<T> mesh;
    std::array<std::span<const T>, 3> axes;
    unsigned threads;
    SweptSurface surface;
    SweptGrid grid; /* of no slab yet */
    DistanceSlack slack;
    double margin;
    std::unique_ptr<const NearVertices> near_vertices;

    /// Flips what is behind a triangle, seen along x.
    void cross_triangle(std::size_t triangle, const SweptGrid& slab, Crossings& crossings) const;
    /// Fills the cells, of whole layers of blocks.
    void find_inside(const SweptGrid& slab, std::span<std::uint64_t> cells) const;
    BlockTies sweep(const SweptGrid& slab, std::span<std::uint64_t> cells) const;
    void add_block(const std::array<std::size_t, 3>& block, std::span<const std::uint64_t, kBlockSamples> cells,
                   std::span<const SweptTie> ties, LayerPlan& plan) const;
    /// Appends what a slab comes to.
    void plan_slab(std::size_t z_first, std::size_t z_count, BlockPlan& plan) const;
};

template <typename T>
void SolidScan<T>::Implementation::cross_triangle(std::size_t triangle, const SweptGrid& slab,
                                                  Crossings& crossings) const {
    std::array<Flat, 3> corners;
    std::array<double, 3> x;
    std::array<uint, 3> ids;
    for (std::size_t i = 0; i < 3; ++i) {
        ids[i] = surface.corners[3 * triangle + i];
        const dvec3 at = double_at(mesh.vertices, ids[i]);
        corners[i] = {at.y, at.z};
        x[i] = at.x;
    }
    // The samples that may be within the triangle's box.
    std::array<std::ptrdiff_t, 3> first{}, end{};
    for (int axis = 1; axis < 3; ++axis) {
        const auto of = [&](const Flat& corner) { return axis == 1 ? corner.y : corner.z; };
        const double low = std::min({of(corners[0]), of(corners[1]), of(corners[2])}),
                     high = std::max({of(corners[0]), of(corners[1]), of(corners[2])});
        const auto i = static_cast<std::size_t>(axis);
        const auto sample = [&](double value, double aside) {
            return static_cast<std::ptrdiff_t>(
                std::clamp(std::floor((value - slab.origin[i]) / slab.spacing[i] + aside), double(slab.first(axis)) - 1,
                           double(slab.end(axis))));
        };
        first[i] = std::max<std::ptrdiff_t>(slab.first(axis), sample(low, -kMostUneven) + 1);
        end[i] = std::min<std::ptrdiff_t>(slab.end(axis), sample(high, kMostUneven) + 1);
        if (first[i] >= end[i])
            return;
    }
    const std::size_t ny = axes[1].size();
    for (std::ptrdiff_t z = first[2]; z < end[2]; ++z)
        for (std::ptrdiff_t y = first[1]; y < end[1]; ++y) {
            const Flat p{static_cast<double>(axes[1][std::size_t(y)]), static_cast<double>(axes[2][std::size_t(z)])};
            std::array<double, 3> weights;
            int left = 0;
            for (std::size_t i = 0; i < 3; ++i) {
                const std::size_t j = (i + 1) % 3, k = (i + 2) % 3; // opposite to corner i
                const Flat &a = corners[j], &b = corners[k];
                weights[i] = (b.y - a.y) * (p.z - a.z) - (b.z - a.z) * (p.y - a.y);
                const bool turned = std::tie(a.y, a.z, x[j], ids[j]) > std::tie(b.y, b.z, x[k], ids[k]);
                left += turned ? !is_left(b, a, p) : is_left(a, b, p);
            }
            if (left != 0 && left != 3)
                continue;
            const double sum = weights[0] + weights[1] + weights[2];
            double at = (weights[0] * x[0] + weights[1] * x[1] + weights[2] * x[2]) / sum;
            const auto [low, high] = std::minmax({x[0], x[1], x[2]});
            at = at > low ? std::min(at, high) : low; // even where the sum is 0
            auto sample = static_cast<std::ptrdiff_t>(
                std::clamp(std::floor((at - slab.origin[0]) / slab.spacing[0]), -1.0, double(axes[0].size())));
            const auto samples = static_cast<std::ptrdiff_t>(axes[0].size());
            sample = std::clamp<std::ptrdiff_t>(sample, 0, samples);
            while (sample > 0 && static_cast<double>(axes[0][std::size_t(sample - 1)]) >= at)
                --sample;
            while (sample < samples && static_cast<double>(axes[0][std::size_t(sample)]) < at)
                ++sample;
            if (sample < samples)
                crossings.flip_from(std::size_t(z - slab.z_first) * ny + std::size_t(y), std::size_t(sample));
        }
}

template <typename T>
void SolidScan<T>::Implementation::find_inside(const SweptGrid& slab, std::span<std::uint64_t> cells) const {
    const std::size_t nx = axes[0].size(), ny = axes[1].size(), nz = std::size_t(slab.z_end - slab.z_first);
    Crossings crossings(nx, ny * nz);
    constexpr std::size_t kRun = 1024;
    reference::share_out(threads, (surface.triangles() + kRun - 1) / kRun, [&](std::size_t, std::size_t run) {
        for (std::size_t t = run * kRun; t < std::min(surface.triangles(), (run + 1) * kRun); ++t)
            cross_triangle(t, slab, crossings);
    });
    const std::size_t layers = (nz + kMeshBlock - 1) / kMeshBlock, in_layer = cells.size() / layers;
    reference::share_out(threads, layers, [&](std::size_t, std::size_t layer) {
        std::ranges::fill(cells.subspan(layer * in_layer, in_layer), kOutsideCell);
        for (std::size_t z = layer * kMeshBlock; z < std::min(nz, (layer + 1) * kMeshBlock); ++z)
            for (std::size_t y = 0; y < ny; ++y) {
                const std::span<const std::uint64_t> bits = crossings.settle(z * ny + y);
                const std::size_t row = std::size_t(slab.part[2][z]) + slab.part[1][y];
                for (std::size_t x = 0; x < nx; ++x)
                    if (bits[x / 64] >> x % 64 & 1u)
                        cells[row + slab.part[0][x]] = kOpenCell;
            }
    });
}

template <typename T>
BlockTies SolidScan<T>::Implementation::sweep(const SweptGrid& slab, std::span<std::uint64_t> cells) const {
    const double near = kNear * double(slack.base);
    const SweepInput input{surface, slab, *near_vertices, slack, margin, near, cells};
    std::vector<SweepOutput> outputs(threads);
    constexpr std::size_t kRun = 256;
    const auto share = [&](std::size_t count, const auto& work) {
        reference::share_out(threads, (count + kRun - 1) / kRun, [&](std::size_t thread, std::size_t run) {
            work(input, run * kRun, std::min(count, (run + 1) * kRun), outputs[thread]);
        });
    };
    share(surface.triangles(), sweep_triangles);
    share(surface.count_vertices(), sweep_vertices);
    // Samples just outside, which the law may find inside, become cells like others.
    std::vector<SweptTie> ties, outside;
    for (SweepOutput& output : outputs) {
        ties.insert(ties.end(), output.ties.begin(), output.ties.end());
        outside.insert(outside.end(), output.outside.begin(), output.outside.end());
        output = {};
    }
    std::vector<std::uint32_t> found;
    const auto limit = static_cast<float>(near * near / 4);
    for (const SweptTie& tie : outside)
        if (tie.square <= limit && cells[tie.cell] == kOutsideCell) {
            cells[tie.cell] = kOpenCell;
            found.push_back(tie.cell);
        }
    for (const SweptTie& tie : outside)
        if (cells[tie.cell] != kOutsideCell)
            cells[tie.cell] = std::min(cells[tie.cell], cell_of(tie.square, tie.triangle));
    ties.insert(ties.end(), outside.begin(), outside.end());
    return sorted_by_block(ties, cells.size() / kBlockSamples);
}

template <typename T>
void SolidScan<T>::Implementation::add_block(const std::array<std::size_t, 3>& block,
                                             std::span<const std::uint64_t, kBlockSamples> cells,
                                             std::span<const SweptTie> ties, LayerPlan& plan) const {
    uint wanted = 0;
    for (std::size_t i = 0; i < kBlockSamples; ++i)
        wanted |= cells[i] == kOutsideCell ? 0 : 1u << i;
    if (wanted == 0)
        return;
    const auto sample = [&](std::size_t axis, std::size_t i) {
        return std::min(block[axis] * kMeshBlock + (i >> axis & 1), axes[axis].size() - 1);
    };
    BlockCells samples;
    std::ranges::copy(cells, samples.cells.begin());
    for (std::size_t i = 0; i < kBlockSamples; ++i) {
        samples.x[i] = grid.at[0][sample(0, i)];
        samples.y[i] = grid.at[1][sample(1, i)];
        samples.z[i] = grid.at[2][sample(2, i)];
    }
    const auto first = static_cast<std::ptrdiff_t>(plan.candidates.size());
    if (std::ranges::find(cells, kOpenCell) != cells.end() ||
        !NearTriangles(surface, slack).find(samples, ties, kMostCandidates, plan.candidates)) {
        plan.candidates.resize(std::size_t(first));
        uint hint = 0;
        for (std::size_t i = 0; i < kBlockSamples; ++i) {
            if ((wanted >> i & 1u) == 0)
                continue;
            hint = cells[i] == kOpenCell ? hint : triangle_of(cells[i]);
            const Vector<T> probe(axes[0][sample(0, i)], axes[1][sample(1, i)], axes[2][sample(2, i)]);
            hint = reference::nearest(mesh, probe, hint).triangle;
            if (std::find(plan.candidates.begin() + first, plan.candidates.end(), hint) == plan.candidates.end())
                plan.candidates.push_back(hint);
        }
    }
    std::sort(plan.candidates.begin() + first, plan.candidates.end());
    plan.blocks.push_back({static_cast<uint>(sample(0, 0)), static_cast<uint>(sample(1, 0)),
                           static_cast<uint>(sample(2, 0)), static_cast<uint>(first),
                           static_cast<uint>(plan.candidates.size() - std::size_t(first))});
    // Behind the last sample of an odd row, chunks of kernels have a copy of it.
    const bool is_cut = block[0] * kMeshBlock + 1 == axes[0].size();
    plan.wanted.push_back(is_cut ? wanted | wanted << 1 : wanted);
    plan.samples += static_cast<std::uint64_t>(std::popcount(wanted));
}

template <typename T>
SolidScan<T>::SolidScan(std::unique_ptr<const Implementation> implementation)
    : implementation_(std::move(implementation)) {}
template <typename T> SolidScan<T>::~SolidScan() = default;

template <typename T>
std::unique_ptr<const SolidScan<T>> SolidScan<T>::make(const layout::MeshView<T>& mesh, std::span<const T> x,
                                                       std::span<const T> y, std::span<const T> z, uint inside,
                                                       unsigned threads) {
    if (inside != layout::kInsidePseudonormal || !mesh.solid || !mesh.clearance)
        return nullptr;
    auto made = std::make_unique<Implementation>();
    made->mesh = mesh;
    made->axes = {x, y, z};
    made->threads = reference::threads_for(threads);
    if (x.size() * y.size() > kMostAtAll / kLayers)
        return nullptr;
    double spacing = std::numeric_limits<double>::infinity();
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (!measure_axis(made->axes[axis], made->grid.origin[axis], made->grid.spacing[axis]))
            return nullptr;
        spacing = std::min(spacing, made->grid.spacing[axis]);
        made->grid.at[axis].assign(made->axes[axis].begin(), made->axes[axis].end());
    }
    SweptSurface& surface = made->surface;
    surface.corners = mesh.triangle_corners;
    surface.neighbours = mesh.triangle_neighbours;
    double volume = 0;
    if (!measure(mesh, surface, volume) || !(volume > 0))
        return nullptr;
    made->slack = slack_of<T>(surface.longest);
    if (!(made->slack.at(surface.deepest) < kLeastGap))
        return nullptr;
    made->margin = kMargin + 2 * kNear * double(made->slack.base) / spacing;
    if (!(made->margin < kMostMargin) || !mesh.clearance->is_enough(threads))
        return nullptr;
    surface.vertices.assign(mesh.vertices.begin(), mesh.vertices.end());
    surface.pseudonormals.assign(mesh.vertex_pseudonormals.begin(), mesh.vertex_pseudonormals.end());
    find_stars(surface);
    made->near_vertices = std::make_unique<const NearVertices>(surface, made->grid);
    return std::unique_ptr<const SolidScan>(new SolidScan(std::move(made)));
}

template <typename T>
void SolidScan<T>::Implementation::plan_slab(std::size_t z_first, std::size_t z_count, BlockPlan& plan) const {
    const auto blocks_of = [](std::size_t samples) { return (samples + kMeshBlock - 1) / kMeshBlock; };
    const std::size_t across = blocks_of(axes[0].size()), along = blocks_of(axes[1].size()),
                      layers = blocks_of(z_count);
    SweptGrid slab = grid;
    slab.z_first = static_cast<int>(z_first);
    slab.z_end = static_cast<int>(z_first + z_count);
    const std::array<std::size_t, 3> counts{axes[0].size(), axes[1].size(), z_count};
    const std::array<std::size_t, 3> strides{1, across, across * along};
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (std::size_t i = 0; i < counts[axis]; ++i)
            slab.part[axis].push_back(
                static_cast<std::uint32_t>(i / kMeshBlock * strides[axis] * kBlockSamples + (i % kMeshBlock << axis)));
    const std::size_t size = across * along * layers * kBlockSamples;
    const auto owned = std::make_unique_for_overwrite<std::uint64_t[]>(size);
    const std::span cells(owned.get(), size);
    find_inside(slab, cells);
    const BlockTies ties = sweep(slab, cells);
    std::vector<LayerPlan> parts(layers);
    reference::share_out(threads, layers, [&](std::size_t, std::size_t layer) {
        for (std::size_t block = layer * strides[2]; block < (layer + 1) * strides[2]; ++block)
            add_block({block % across, block / across % along, z_first / kMeshBlock + layer},
                      std::span<const std::uint64_t, kBlockSamples>(&cells[block * kBlockSamples], kBlockSamples),
                      ties.of(block), parts[layer]);
    });
    for (const LayerPlan& part : parts) {
        const auto first = static_cast<uint>(plan.candidates.size());
        for (layout::MeshBlock block : part.blocks) {
            block.first += first;
            plan.blocks.push_back(block);
        }
        plan.candidates.insert(plan.candidates.end(), part.candidates.begin(), part.candidates.end());
        plan.wanted.insert(plan.wanted.end(), part.wanted.begin(), part.wanted.end());
        plan.voxels_evaluated += part.samples;
    }
}

template <typename T> BlockPlan SolidScan<T>::plan(std::size_t z_first, std::size_t z_count) const {
    const Implementation& scan = *implementation_;
    const std::size_t layer = scan.axes[0].size() * scan.axes[1].size(), end = z_first + z_count;
    const std::size_t step = std::max<std::size_t>(1, kMostSamples / layer / kLayers) * kLayers;
    BlockPlan plan;
    for (std::size_t z = z_first; z < end; z += step)
        scan.plan_slab(z, std::min(step, end - z), plan);
    return plan;
}

template class SolidScan<float>;
template class SolidScan<double>;

} // namespace forceshade
