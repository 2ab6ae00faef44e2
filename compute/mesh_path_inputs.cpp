#include "compute/mesh_path_inputs.h"

#include <algorithm>
#include <vector>

#include "compute/mesh_needs.h"
#include "compute/mesh_obstacles.h"
#include "compute/path_inputs.h"

namespace forceshade::compute {
namespace {

using layout::uint;

template <typename Value> std::span<const std::byte> bytes_of(const std::vector<Value>& values) {
    return std::as_bytes(std::span<const Value>(values));
}

} // namespace

template <typename T> void MeshPathInputs::upload_triangles(const layout::Law<T>& law) {
    const layout::MeshView<T>& mesh = law.mesh;
    const std::size_t triangles = mesh.triangle_facets.size();
    const MeshObstacles obstacles = find_obstacles(mesh);
    std::vector<uint> indices;
    if (reads_corners(law.features)) {
        indices.assign(mesh.facet_begins.begin(), mesh.facet_begins.end());
        indices.insert(indices.end(), mesh.facet_corners.begin(), mesh.facet_corners.end());
    }
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
    buffers_.upload(layout::kMeshPathBindTriangles, bytes_of(words));
    buffers_.upload(layout::kMeshPathBindIndices, bytes_of(indices));
}

template <typename T> void MeshPathInputs::upload_vectors(const layout::Law<T>& law) {
    const layout::MeshView<T>& mesh = law.mesh;
    const std::size_t triangles = mesh.triangle_facets.size();
    const std::size_t vertices = reads_corners(law.features) ? mesh.vertices.size() / 3 : 0;
    const std::size_t facets = reads_facet_normals(law.features) ? mesh.facet_normals.size() / 3 : 0;
    vertices_ = static_cast<uint>(3 * triangles + facets);
    std::vector<T> table;
    table.reserve(4 * (vertices_ + 2 * vertices));
    const auto add = [&](std::span<const T> from, std::size_t i, T beside) {
        table.insert(table.end(), {from[3 * i], from[3 * i + 1], from[3 * i + 2], beside});
    };
    for (std::size_t t = 0; t < triangles; ++t)
        for (std::size_t i = 0; i < 3; ++i)
            add(mesh.vertices, mesh.triangle_corners[3 * t + i], mesh.triangle_normals[3 * t + i]);
    for (std::size_t f = 0; f < facets; ++f)
        add(mesh.facet_normals, f, T(0));
    for (std::size_t v = 0; v < vertices; ++v) {
        add(mesh.vertices, v, T(0));
        add(mesh.vertex_normals, v, T(0));
    }
    buffers_.upload(layout::kMeshPathBindVectors, bytes_of(table));
}

template <typename T> void MeshPathInputs::upload(const layout::Law<T>& law) {
    const layout::MeshLawParams<T> params{law.params, law.mesh.params};
    buffers_.upload(layout::kMeshPathBindLaw, std::as_bytes(std::span(&params, 1)));
    buffers_.upload(layout::kMeshPathBindMapGradients, std::as_bytes(law.map_gradients));
    buffers_.upload(layout::kMeshPathBindTextureGradients, std::as_bytes(law.texture_gradients));
    buffers_.upload(layout::kMeshPathBindNodes, std::as_bytes(law.mesh.nodes));
    upload_vectors(law);
    upload_triangles(law);
}

template <typename T>
void MeshPathInputs::upload(const layout::PathInput<T>& input, const layout::PathBatch<T>& batch) {
    buffers_.upload(layout::kMeshPathBindMotions, std::as_bytes(motions_of(batch)));
    buffers_.upload(layout::kMeshPathBindHarmonics, bytes_of(harmonics_of(batch)));
    buffers_.upload(layout::kMeshPathBindHands, std::as_bytes(hands_of(input, batch)));
}

template void MeshPathInputs::upload<float>(const layout::Law<float>&);
template void MeshPathInputs::upload<double>(const layout::Law<double>&);
template void MeshPathInputs::upload<float>(const layout::PathInput<float>&, const layout::PathBatch<float>&);
template void MeshPathInputs::upload<double>(const layout::PathInput<double>&, const layout::PathBatch<double>&);

} // namespace forceshade::compute
