#include "host/mesh/marks.h"

#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "host/mesh/pieces.h"
#include "host/mesh/places.h"
#include "host/mesh/self_intersections.h"

namespace forceshade {

namespace {

glm::dvec3 vector_at(const std::vector<double>& numbers, std::size_t i) {
    return {numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]};
}

void mark_edges(const MeshStructure& structure, MeshMarks& marks) {
    const MeshParts& parts = *structure.parts;
    const MeshReals<double>& reals = *structure.reals;
    const double cosine = std::cos(MeshMarks::kSharp * std::numbers::pi / 180);
    const auto world = [&](layout::uint corner) {
        return structure.centre + structure.scale * vector_at(reals.vertices, parts.triangle_corners[corner]);
    };
    for (layout::uint edge = 0; edge < parts.triangle_neighbours.size(); ++edge) {
        const layout::uint triangle = edge / 3, across = parts.triangle_neighbours[edge];
        std::vector<MeshMarks::Edge>* into = nullptr;
        if (across == layout::kMeshBorder)
            into = &marks.rims;
        else if ((across & layout::kMeshManyBit) != 0)
            into = &marks.crowded;
        else if (triangle < across && parts.triangle_facets[triangle] != parts.triangle_facets[across] &&
                 glm::dot(vector_at(reals.triangle_normals, triangle), vector_at(reals.triangle_normals, across)) <
                     cosine)
            into = &marks.sharp;
        if (into)
            into->push_back({world(edge), world(edge % 3 == 2 ? edge - 2 : edge + 1)});
    }
}

} // namespace

MeshMarks find_marks(const Mesh& mesh, const MeshStructure& structure, const MeshFindings& findings) {
    MeshMarks marks;
    mark_edges(structure, marks);
    marks.inward.resize(mesh.polygons.facets());
    if (findings.misoriented_edges > 0 || !findings.inside_out.empty() || findings.volume < 0) {
        const MeshPieces pieces = find_pieces(mesh.polygons);
        for (std::size_t facet = 0; facet < marks.inward.size(); ++facet)
            marks.inward[facet] = pieces.opposed[facet] || pieces.pieces[pieces.of_facet[facet]].is_inside_out();
    }
    if (findings.self_intersections.value_or(0) > 0) {
        constexpr std::size_t kMostPairs = 100'000;
        marks.crossing =
            count_self_intersections(mesh.polygons, weld(mesh.polygons), mesh.triangles, kMostPairs).triangles;
    }
    return marks;
}

} // namespace forceshade
