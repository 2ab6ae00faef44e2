// The tables that kernels read.
#include <algorithm>
#include <array>
#include <cmath>
#include <thread>
#include <type_traits>

#include "compute/plan.h"
#include "host/threads.h"

namespace forceshade::compute {
namespace {

using layout::uint;

// L7 interpolates the normals of the vertices around a facet: without it neither these nor places nor corners are read.
bool reads_corners(const layout::Features& features) {
    return features.shading != layout::kShadingNone;
}

// L7 starts from the facet's normal; L8 and L9 need its plane.
bool reads_facet_normals(const layout::Features& features) {
    return features.shading != layout::kShadingNone || features.map != layout::kMapNone ||
           features.texture != layout::kMapNone;
}

// Of a field: what lies around a triangle decides the inside, unless the winding number does.
bool reads_pseudonormals(const layout::Features& features) {
    return features.inside == layout::kInsidePseudonormal;
}

template <typename Value> std::span<const std::byte> bytes_in(const std::vector<Value>& values) {
    return std::as_bytes(std::span<const Value>(values));
}

// The axes x, y, z, of which x is padded with its last sample to a multiple of `lanes`.
template <typename T> std::vector<T> axes_of(const layout::FieldInput<T>& input, std::uint32_t lanes) {
    std::vector<T> axes(input.x.begin(), input.x.end());
    axes.resize(divide_up(axes.size(), lanes) * lanes, input.x.back());
    axes.insert(axes.end(), input.y.begin(), input.y.end());
    axes.insert(axes.end(), input.z.begin(), input.z.end());
    return axes;
}

template <typename T> void put_gradients(const layout::Law<T>& law, uint map, uint texture, const PutTable& put) {
    put(map, std::as_bytes(law.map_gradients));
    put(texture, std::as_bytes(law.texture_gradients));
}

template <typename T> void put_mesh_law(const layout::Law<T>& law, uint binding, const PutTable& put) {
    const layout::MeshLawParams<T> params{law.params, law.mesh.params};
    put(binding, std::as_bytes(std::span(&params, 1)));
}

template <typename T> using Point = std::array<T, 3>;

template <typename T> Point<T> point_at(std::span<const T> table, std::size_t index) {
    return {table[3 * index], table[3 * index + 1], table[3 * index + 2]};
}

template <typename T> Point<T> minus(const Point<T>& u, const Point<T>& v) {
    return {u[0] - v[0], u[1] - v[1], u[2] - v[2]};
}

template <typename T> T product(const Point<T>& u, const Point<T>& v) {
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

// A triangle.
template <typename T> struct Shape {
    std::array<Point<T>, 3> corners;
    Point<T> normal;

    Shape(const layout::MeshView<T>& mesh, std::size_t triangle) : normal(point_at(mesh.triangle_normals, triangle)) {
        for (std::size_t i = 0; i < 3; ++i)
            corners[i] = point_at(mesh.vertices, mesh.triangle_corners[3 * triangle + i]);
    }
};

// Each triangle's place in the order of (facet, triangle).
template <typename T> std::vector<uint> places(const layout::MeshView<T>& mesh) {
    std::vector<uint> begin(std::size_t(mesh.params.facets) + 1, 0);
    for (const uint facet : mesh.triangle_facets)
        ++begin[facet + 1];
    for (std::size_t f = 1; f < begin.size(); ++f)
        begin[f] += begin[f - 1];
    std::vector<uint> place;
    place.reserve(mesh.triangle_facets.size());
    for (const uint facet : mesh.triangle_facets)
        place.push_back(begin[facet]++);
    return place;
}

// The corners of a triangle by (x, y, z), which is how the law walks its edges; and what the law must know of the order
// that they had: layout::kMeshCandidate...
template <typename T> struct SortedCorners {
    std::array<Point<T>, 3> points;
    bool turned = false;
    uint bits = 0;

    explicit SortedCorners(const std::array<Point<T>, 3>& corners) {
        std::array<uint, 3> order{0, 1, 2};
        const auto sort = [&](std::size_t i, std::size_t j) {
            if (corners[order[j]] < corners[order[i]])
                std::swap(order[i], order[j]);
        };
        sort(0, 1);
        sort(1, 2);
        sort(0, 1);
        for (std::size_t i = 0; i < 3; ++i)
            points[i] = corners[order[i]];
        turned = order[1] != (order[0] + 1) % 3;
        const auto sorted_place = [&](uint corner) {
            return static_cast<uint>(std::ranges::find(order, corner) - order.begin());
        };
        bits = (turned ? layout::kMeshCandidateTurned : 0) | sorted_place(0) << layout::kMeshCandidateFirst;
        uint longest = 0; // the first of equals, as in the law
        T square = T(0);
        for (uint i = 0; i < 3; ++i)
            if (const Point<T> edge = minus(corners[(i + 1) % 3], corners[i]); product(edge, edge) > square) {
                longest = i;
                square = product(edge, edge);
            }
        // Sorted edges: low to middle, middle to high, low to high.
        const uint sum = sorted_place(longest) + sorted_place((longest + 1) % 3);
        bits |= (sum == 1 ? 0u : sum == 3 ? 1u : 2u) << layout::kMeshCandidateLongest;
    }
};

template <typename T>
void add_vector(std::span<const T> table, std::size_t index, std::vector<T>& to, T fourth = T(0)) {
    to.insert(to.end(), {table[3 * index], table[3 * index + 1], table[3 * index + 2], fourth});
}

template <typename T>
std::vector<uint> put_triangles(const layout::MeshView<T>& mesh, const layout::Features& features,
                                const PutTable& put) {
    const std::size_t triangles = mesh.triangle_facets.size();
    const std::vector<uint> place = places(mesh);
    std::vector<uint> candidates(triangles);
    std::vector<T> records(12 * triangles);
    for (std::size_t t = 0; t < triangles; ++t) {
        const Shape<T> shape(mesh, t);
        const SortedCorners<T> sorted(shape.corners);
        candidates[t] = place[t] << layout::kMeshCandidateShift | sorted.bits;
        T* const record = &records[12 * std::size_t(place[t])];
        for (std::size_t i = 0; i < 3; ++i) {
            std::ranges::copy(sorted.points[i], record + 4 * i);
            record[4 * i + 3] = sorted.turned ? -shape.normal[i] : shape.normal[i];
        }
    }
    put(layout::kMeshBindRecords, bytes_in(records));
    const bool around = reads_pseudonormals(features);
    std::vector<uint> words(around ? 8 * triangles : (triangles + 3) / 4 * 4);
    for (std::size_t t = 0; t < triangles; ++t) {
        if (!around) {
            words[place[t]] = mesh.triangle_facets[t];
            continue;
        }
        uint* const to = &words[8 * std::size_t(place[t])];
        std::ranges::copy(mesh.triangle_corners.subspan(3 * t, 3), to);
        to[3] = mesh.triangle_facets[t];
        for (std::size_t i = 0; i < 3; ++i) {
            const uint across = mesh.triangle_neighbours[3 * t + i];
            to[4 + i] = across & layout::kMeshManyBit
                            ? across
                            : place[across] << 1 | (candidates[across] & layout::kMeshCandidateTurned);
        }
    }
    put(layout::kMeshBindTriangles, bytes_in(words));
    return candidates;
}

template <typename T>
void put_vertices(const layout::MeshView<T>& mesh, const layout::Features& features, const PutTable& put) {
    const std::size_t count = mesh.vertices.size() / 3;
    std::vector<T> vectors;
    vectors.reserve(4 * count * ((reads_corners(features) ? 2 : 0) + (reads_pseudonormals(features) ? 1 : 0)));
    for (std::size_t v = 0; v < count; ++v) {
        if (reads_corners(features)) {
            add_vector(mesh.vertices, v, vectors);
            add_vector(mesh.vertex_normals, v, vectors);
        }
        if (reads_pseudonormals(features))
            add_vector(mesh.vertex_pseudonormals, v, vectors);
    }
    put(layout::kMeshBindVertices, bytes_in(vectors));
}

// Where the facets begin, and their corners.
template <typename T> std::vector<uint> facet_table(const layout::MeshView<T>& mesh) {
    std::vector<uint> table(mesh.facet_begins.begin(), mesh.facet_begins.end());
    table.insert(table.end(), mesh.facet_corners.begin(), mesh.facet_corners.end());
    return table;
}

template <typename T>
void put_facets(const layout::MeshView<T>& mesh, const layout::Features& features, const PutTable& put) {
    std::vector<T> normals;
    if (reads_facet_normals(features))
        for (std::size_t f = 0; f < mesh.facet_normals.size() / 3; ++f)
            add_vector(mesh.facet_normals, f, normals);
    if (reads_pseudonormals(features))
        for (std::size_t e = 0; e < mesh.edge_pseudonormals.size() / 3; ++e)
            add_vector(mesh.edge_pseudonormals, e, normals);
    put(layout::kMeshBindNormals, bytes_in(normals));
    if (!reads_corners(features))
        return;
    put(layout::kMeshBindFacets, bytes_in(facet_table(mesh)));
}

// The triangles that may block a proxy that slides over a face, found once for a mesh, so that the kernel of paths
// needs no tree for most steps: for each triangle, those that a proxy may approach while the plane of its front
// holds it a skin away and it is above the triangle or no more than two skins outside of it; and the same at the back.
// Triangles below that plane, as the law has it, are left out.
struct MeshObstacles {
    std::vector<layout::uint> triangles;
    std::vector<layout::uint> front; /* where a triangle's begin; those of its back follow, up to the next one's */
    std::vector<layout::uint> back;
    std::vector<bool> crowded; /* too many to list */
};

// The skin of the law (Skin<T>::kWidth), and how far below a plane a corner may be above it.
template <typename T> constexpr T kSkin = std::is_same_v<T, double> ? T(0x1p-40) : T(0x1p-15);
template <typename T> constexpr T kFlush = kSkin<T>* T(0.015625) * T(0.25);
constexpr std::size_t kMostListed = 48; // of either side

template <typename T> Point<T> cross(const Point<T>& u, const Point<T>& v) {
    return {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
}

// Where a proxy may be that slides over a triangle, and what lies near there.
template <typename T> class Surroundings {
public:
    Surroundings(const layout::MeshView<T>& mesh, std::size_t triangle)
        : mesh_(mesh), own_(triangle), shape_(mesh, triangle) {
        double sharpest = 1; // sine of half an angle
        for (std::size_t i = 0; i < 3; ++i) {
            const Point<T> edge = minus(shape_.corners[(i + 1) % 3], shape_.corners[i]);
            const Point<T> other = minus(shape_.corners[(i + 2) % 3], shape_.corners[i]);
            const double cosine =
                double(product(edge, other)) / std::sqrt(double(product(edge, edge)) * double(product(other, other)));
            sharpest = std::min(sharpest, std::sqrt(std::max(0.0, (1 - cosine) / 2)));
            inwards_[i] = cross(shape_.normal, edge);
            lengths_[i] = std::sqrt(product(edge, edge));
        }
        const T reach = kSkin<T> * (T(4) + T(2 / std::max(sharpest, 1e-6)));
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto [low, high] =
                std::minmax({shape_.corners[0][axis], shape_.corners[1][axis], shape_.corners[2][axis]});
            low_[axis] = low - reach;
            high_[axis] = high + reach;
        }
    }

    // Adds what lies near to `front` and `back`; false if it is too much.
    bool find(std::vector<uint>& front, std::vector<uint>& back) {
        constexpr std::size_t kMostLooked = 1024;
        std::size_t looked = 0;
        stack_.assign(1, 0);
        while (!stack_.empty()) {
            const layout::MeshNode& node = mesh_.nodes[stack_.back()];
            stack_.pop_back();
            for (uint i = 0; i < layout::kMeshChildren; ++i) {
                if (node.child[i] == layout::kMeshNoChild || !meets(node, i))
                    continue;
                if ((node.child[i] & layout::kMeshLeaf) == 0) {
                    stack_.push_back(node.child[i]);
                    continue;
                }
                const uint first = (node.child[i] & ~layout::kMeshLeaf) / layout::kMeshLeafTriangles;
                for (uint t = first; t <= first + node.child[i] % layout::kMeshLeafTriangles; ++t)
                    put(t, front, back);
                if (++looked > kMostLooked || front.size() > kMostListed || back.size() > kMostListed)
                    return false;
            }
        }
        return true;
    }

private:
    bool meets(const layout::MeshNode& node, uint i) const {
        return T(node.low_x[i]) <= high_[0] && T(node.high_x[i]) >= low_[0] && T(node.low_y[i]) <= high_[1] &&
               T(node.high_y[i]) >= low_[1] && T(node.low_z[i]) <= high_[2] && T(node.high_z[i]) >= low_[2];
    }

    void put(uint triangle, std::vector<uint>& front, std::vector<uint>& back) const {
        if (triangle == own_)
            return;
        constexpr T kReach = T(4) * kSkin<T>;
        const Shape<T> other(mesh_, triangle);
        std::array<T, 3> heights;
        for (std::size_t i = 0; i < 3; ++i)
            heights[i] = product(shape_.normal, minus(other.corners[i], shape_.corners[0]));
        if (std::ranges::all_of(heights, [](T h) { return h > kReach; }) ||
            std::ranges::all_of(heights, [](T h) { return h < -kReach; }))
            return;
        for (std::size_t edge = 0; edge < 3; ++edge)
            if (std::ranges::all_of(other.corners, [&](const Point<T>& corner) {
                    return product(inwards_[edge], minus(corner, shape_.corners[edge])) < -kReach * lengths_[edge];
                }))
                return;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto [low, high] =
                std::minmax({other.corners[0][axis], other.corners[1][axis], other.corners[2][axis]});
            if (low > high_[axis] || high < low_[axis])
                return;
        }
        // As the law has it, to the last bit.
        if (!std::ranges::all_of(heights, [](T h) { return h <= kFlush<T>; }))
            front.push_back(triangle);
        if (!std::ranges::all_of(heights, [](T h) { return -h <= kFlush<T>; }))
            back.push_back(triangle);
    }

    const layout::MeshView<T>& mesh_;
    std::size_t own_;
    Shape<T> shape_;
    std::array<Point<T>, 3> inwards_;
    std::array<T, 3> lengths_;
    Point<T> low_, high_;
    std::vector<uint> stack_;
};

template <typename T> MeshObstacles obstacles_of(const layout::MeshView<T>& mesh, std::size_t first, std::size_t last) {
    MeshObstacles part;
    std::vector<uint> front, back;
    for (std::size_t t = first; t < last; ++t) {
        front.clear();
        back.clear();
        const bool crowded = !Surroundings<T>(mesh, t).find(front, back);
        if (crowded) {
            front.clear();
            back.clear();
        }
        part.crowded.push_back(crowded);
        part.front.push_back(static_cast<uint>(part.triangles.size()));
        part.triangles.insert(part.triangles.end(), front.begin(), front.end());
        part.back.push_back(static_cast<uint>(part.triangles.size()));
        part.triangles.insert(part.triangles.end(), back.begin(), back.end());
    }
    return part;
}

template <typename T> MeshObstacles find_obstacles(const layout::MeshView<T>& mesh) {
    const std::size_t count = mesh.triangle_facets.size();
    const std::size_t threads = std::clamp<std::size_t>(most_threads(), 1, 1 + count / 4096);
    std::vector<MeshObstacles> parts(threads);
    {
        std::vector<std::jthread> helpers;
        for (std::size_t i = 0; i < threads; ++i)
            helpers.emplace_back(
                [&, i] { parts[i] = obstacles_of(mesh, count * i / threads, count * (i + 1) / threads); });
    }
    MeshObstacles all;
    for (const MeshObstacles& part : parts) {
        const auto begin = static_cast<uint>(all.triangles.size());
        all.triangles.insert(all.triangles.end(), part.triangles.begin(), part.triangles.end());
        for (const uint at : part.front)
            all.front.push_back(begin + at);
        for (const uint at : part.back)
            all.back.push_back(begin + at);
        all.crowded.insert(all.crowded.end(), part.crowded.begin(), part.crowded.end());
    }
    all.front.push_back(static_cast<uint>(all.triangles.size()));
    return all;
}

template <typename T> void put_path_triangles(const layout::Law<T>& law, const PutTable& put) {
    const layout::MeshView<T>& mesh = law.mesh;
    const std::size_t triangles = mesh.triangle_facets.size();
    const MeshObstacles obstacles = find_obstacles(mesh);
    std::vector<uint> indices = reads_corners(law.features) ? facet_table(mesh) : std::vector<uint>();
    const auto first = static_cast<uint>(indices.size());
    indices.insert(indices.end(), obstacles.triangles.begin(), obstacles.triangles.end());
    std::vector<uint> words(8 * triangles);
    for (std::size_t t = 0; t < triangles; ++t) {
        uint* const to = &words[8 * t];
        to[0] = mesh.triangle_facets[t];
        std::ranges::copy(mesh.triangle_neighbours.subspan(3 * t, 3), to + 1);
        to[4] = first + obstacles.front[t];
        to[5] = first + obstacles.back[t];
        to[6] = first + obstacles.front[t + 1];
        to[7] = obstacles.crowded[t] ? layout::kTriangleCrowded : 0;
    }
    put(layout::kMeshPathBindTriangles, bytes_in(words));
    put(layout::kMeshPathBindIndices, bytes_in(indices));
}

template <typename T> uint put_path_vectors(const layout::Law<T>& law, const PutTable& put) {
    const layout::MeshView<T>& mesh = law.mesh;
    const std::size_t triangles = mesh.triangle_facets.size();
    const std::size_t vertices = reads_corners(law.features) ? mesh.vertices.size() / 3 : 0;
    const std::size_t facets = reads_facet_normals(law.features) ? mesh.facet_normals.size() / 3 : 0;
    const auto begin = static_cast<uint>(3 * triangles + facets);
    std::vector<T> table;
    table.reserve(4 * (begin + 2 * vertices));
    for (std::size_t t = 0; t < triangles; ++t)
        for (std::size_t i = 0; i < 3; ++i)
            add_vector(mesh.vertices, mesh.triangle_corners[3 * t + i], table, mesh.triangle_normals[3 * t + i]);
    for (std::size_t f = 0; f < facets; ++f)
        add_vector(mesh.facet_normals, f, table);
    for (std::size_t v = 0; v < vertices; ++v) {
        add_vector(mesh.vertices, v, table);
        add_vector(mesh.vertex_normals, v, table);
    }
    put(layout::kMeshPathBindVectors, bytes_in(table));
    return begin;
}

} // namespace

template <typename T>
void put_field_tables(const layout::FieldInput<T>& input, std::uint32_t lanes, const PutTable& put) {
    put(layout::kBindLaw, std::as_bytes(std::span(&input.law.params, 1)));
    put(layout::kBindAxes, bytes_in(axes_of(input, lanes)));
    put(layout::kBindFacetVertices, std::as_bytes(input.law.facet_vertices));
    put_gradients(input.law, layout::kBindMapGradients, layout::kBindTextureGradients, put);
}

template <typename T> std::vector<uint> put_mesh_tables(const layout::FieldInput<T>& input, const PutTable& put) {
    const layout::MeshView<T>& mesh = input.law.mesh;
    put_mesh_law(input.law, layout::kMeshBindLaw, put);
    put(layout::kMeshBindAxes, bytes_in(axes_of(input, layout::kMeshBlock)));
    put_gradients(input.law, layout::kMeshBindMapGradients, layout::kMeshBindTextureGradients, put);
    put_vertices(mesh, input.law.features, put);
    put_facets(mesh, input.law.features, put);
    return put_triangles(mesh, input.law.features, put);
}

template <typename T> void put_path_tables(const layout::Law<T>& law, const PutTable& put) {
    put(layout::kPathBindLaw, std::as_bytes(std::span(&law.params, 1)));
    put(layout::kPathBindFacetVertices, std::as_bytes(law.facet_vertices));
    put_gradients(law, layout::kPathBindMapGradients, layout::kPathBindTextureGradients, put);
}

template <typename T> uint put_mesh_path_tables(const layout::Law<T>& law, const PutTable& put) {
    put_mesh_law(law, layout::kMeshPathBindLaw, put);
    put_gradients(law, layout::kMeshPathBindMapGradients, layout::kMeshPathBindTextureGradients, put);
    put_path_triangles(law, put);
    return put_path_vectors(law, put);
}

template <typename T>
void put_batch_tables(const layout::PathInput<T>& input, const layout::PathBatch<T>& batch, uint motions,
                      const PutTable& put) {
    // Recorded paths have an empty motion, an open loop an empty hand: one for all.
    const layout::MotionParams<T> no_motion{};
    const layout::HandParams<T> no_hand{};
    std::vector<layout::Harmonic<T>> harmonics;
    harmonics.reserve(batch.amplitudes.size());
    for (std::size_t i = 0; i < batch.amplitudes.size(); ++i)
        harmonics.push_back({batch.amplitudes[i], batch.phases[i], batch.phase_steps[i]});
    auto hands = input.hands;
    if (hands.empty())
        hands = {&no_hand, 1};
    else if (hands.size() > 1)
        hands = hands.subspan(batch.first, batch.count);
    put(motions, std::as_bytes(batch.motions.empty() ? std::span(&no_motion, 1) : batch.motions));
    put(motions + 1, bytes_in(harmonics));
    put(motions + 2, std::as_bytes(hands));
}

#define FS_INSTANTIATE(T)                                                                                              \
    template void put_field_tables<T>(const layout::FieldInput<T>&, std::uint32_t, const PutTable&);                   \
    template std::vector<uint> put_mesh_tables<T>(const layout::FieldInput<T>&, const PutTable&);                      \
    template void put_path_tables<T>(const layout::Law<T>&, const PutTable&);                                          \
    template uint put_mesh_path_tables<T>(const layout::Law<T>&, const PutTable&);                                     \
    template void put_batch_tables<T>(const layout::PathInput<T>&, const layout::PathBatch<T>&, uint, const PutTable&);
FS_INSTANTIATE(float)
FS_INSTANTIATE(double)

} // namespace forceshade::compute
