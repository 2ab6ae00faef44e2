#include "compute/mesh_inputs.h"

#include <algorithm>
#include <array>

#include "compute/mesh_needs.h"

namespace forceshade::compute {
namespace {

using layout::uint;

template <typename T> using Point = std::array<T, 3>;

template <typename T> Point<T> point_at(std::span<const T> table, std::size_t index) {
    return {table[3 * index], table[3 * index + 1], table[3 * index + 2]};
}

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

template <typename T> T square_of_edge(const Point<T>& from, const Point<T>& to) {
    const T x = to[0] - from[0], y = to[1] - from[1], z = to[2] - from[2];
    return x * x + y * y + z * z;
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
            if (const T edge = square_of_edge(corners[i], corners[(i + 1) % 3]); edge > square) {
                longest = i;
                square = edge;
            }
        // Sorted edges: low to middle, middle to high, low to high.
        const uint sum = sorted_place(longest) + sorted_place((longest + 1) % 3);
        bits |= (sum == 1 ? 0u : sum == 3 ? 1u : 2u) << layout::kMeshCandidateLongest;
    }
};

template <typename T> void add_vector(std::span<const T> table, std::size_t index, std::vector<T>& to) {
    to.insert(to.end(), {table[3 * index], table[3 * index + 1], table[3 * index + 2], T(0)});
}

} // namespace

template <typename T>
void MeshInputs::upload_triangles(const layout::MeshView<T>& mesh, const layout::Features& features) {
    const std::size_t triangles = mesh.triangle_facets.size();
    const std::vector<uint> place = places(mesh);
    candidates_.resize(triangles);
    std::vector<T> records(12 * triangles);
    for (std::size_t t = 0; t < triangles; ++t) {
        std::array<Point<T>, 3> corners;
        for (std::size_t i = 0; i < 3; ++i)
            corners[i] = point_at(mesh.vertices, mesh.triangle_corners[3 * t + i]);
        const SortedCorners<T> sorted(corners);
        candidates_[t] = place[t] << layout::kMeshCandidateShift | sorted.bits;
        T* const record = &records[12 * std::size_t(place[t])];
        for (std::size_t i = 0; i < 3; ++i) {
            const T normal = mesh.triangle_normals[3 * t + i];
            std::ranges::copy(sorted.points[i], record + 4 * i);
            record[4 * i + 3] = sorted.turned ? -normal : normal;
        }
    }
    buffers_.upload(layout::kMeshBindRecords, std::as_bytes(std::span<const T>(records)));
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
                            : place[across] << 1 | (candidates_[across] & layout::kMeshCandidateTurned);
        }
    }
    buffers_.upload(layout::kMeshBindTriangles, std::as_bytes(std::span<const uint>(words)));
}

template <typename T>
void MeshInputs::upload_vertices(const layout::MeshView<T>& mesh, const layout::Features& features) {
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
    buffers_.upload(layout::kMeshBindVertices, std::as_bytes(std::span<const T>(vectors)));
}

template <typename T>
void MeshInputs::upload_facets(const layout::MeshView<T>& mesh, const layout::Features& features) {
    std::vector<T> normals;
    if (reads_facet_normals(features))
        for (std::size_t f = 0; f < mesh.facet_normals.size() / 3; ++f)
            add_vector(mesh.facet_normals, f, normals);
    if (reads_pseudonormals(features))
        for (std::size_t e = 0; e < mesh.edge_pseudonormals.size() / 3; ++e)
            add_vector(mesh.edge_pseudonormals, e, normals);
    buffers_.upload(layout::kMeshBindNormals, std::as_bytes(std::span<const T>(normals)));
    if (!reads_corners(features))
        return;
    std::vector<uint> facets(mesh.facet_begins.begin(), mesh.facet_begins.end());
    facets.insert(facets.end(), mesh.facet_corners.begin(), mesh.facet_corners.end());
    buffers_.upload(layout::kMeshBindFacets, std::as_bytes(std::span<const uint>(facets)));
}

template <typename T> void MeshInputs::upload(const layout::FieldInput<T>& input) {
    const std::size_t pitch = (input.x.size() + layout::kMeshBlock - 1) / layout::kMeshBlock * layout::kMeshBlock;
    x_pitch_ = static_cast<std::uint32_t>(pitch);
    std::vector<T> axes(input.x.begin(), input.x.end());
    axes.resize(pitch, input.x.back());
    axes.insert(axes.end(), input.y.begin(), input.y.end());
    axes.insert(axes.end(), input.z.begin(), input.z.end());
    const layout::MeshLawParams<T> params{input.law.params, input.law.mesh.params};
    buffers_.upload(layout::kMeshBindLaw, std::as_bytes(std::span(&params, 1)));
    buffers_.upload(layout::kMeshBindAxes, std::as_bytes(std::span<const T>(axes)));
    buffers_.upload(layout::kMeshBindMapGradients, std::as_bytes(input.law.map_gradients));
    buffers_.upload(layout::kMeshBindTextureGradients, std::as_bytes(input.law.texture_gradients));
    upload_triangles(input.law.mesh, input.law.features);
    upload_vertices(input.law.mesh, input.law.features);
    upload_facets(input.law.mesh, input.law.features);
}

template void MeshInputs::upload<float>(const layout::FieldInput<float>&);
template void MeshInputs::upload<double>(const layout::FieldInput<double>&);

} // namespace forceshade::compute
