#include "tests/mesh/patch_errors.h"

#include <algorithm>
#include <cmath>

#include "host/mesh/mesh.h"
#include "host/reference/mesh_contact.h"
#include "host/touch/angle.h"

namespace forceshade::study {
namespace {

using layout::uint;
using Vector = reference::Vector<double>;

MeshStructure structure_of(const PolygonSoup& polygons) {
    return build_structure(prepare_mesh(polygons, MeshPlacement{}, VertexNormals::plain));
}

} // namespace

const SmoothSurface kUnitCylinder{"cylinder", [](double x, double) { return std::sqrt(1 - x * x); },
                                  [](double x, double) { return Vector(x, 0, std::sqrt(1 - x * x)); }};
const SmoothSurface kUnitSphere{"sphere", [](double x, double y) { return std::sqrt(1 - x * x - y * y); },
                                [](double x, double y) { return Vector(x, y, std::sqrt(1 - x * x - y * y)); }};
const SmoothSurface kSaddle{"saddle", [](double x, double y) { return (x * x - y * y) / 2; },
                            [](double x, double y) { return Vector(-x, y, 1); }};

PatchStudy::PatchStudy(const SmoothSurface& smooth, Cells kind, unsigned cells, double within)
    : smooth_(smooth), polygons_(patch(kind, cells, smooth.height)), structure_(structure_of(polygons_)),
      tables_(make_mesh_tables<double>(structure_, 1)), mesh_(tables_.view()) {
    for (uint facet = 0; facet < polygons_.facets(); ++facet)
        for (uint i = polygons_.begins[facet]; i < polygons_.begins[facet + 1]; ++i)
            facets_of_[edge_of(facet, i)].push_back(facet);
    std::vector<bool> on_border(polygons_.vertices.size());
    for (const auto& [ends, facets] : facets_of_)
        if (facets.size() == 1)
            on_border[ends.first] = on_border[ends.second] = true;
    for (uint facet = 0; facet < polygons_.facets(); ++facet)
        counts_.push_back(counts(facet, on_border, within));
}

bool PatchStudy::counts(uint facet, const std::vector<bool>& on_border, double within) const {
    for (uint i = polygons_.begins[facet]; i < polygons_.begins[facet + 1]; ++i) {
        const glm::dvec3& at = polygons_.vertices[polygons_.corners[i]];
        if (on_border[polygons_.corners[i]] || std::abs(at.x) > within + 1e-12 || std::abs(at.y) > within + 1e-12)
            return false;
    }
    return true;
}

PatchErrors PatchStudy::errors(uint shading) const {
    double squares = 0, area = 0, largest = 0, jump = 0;
    for (uint facet = 0; facet < polygons_.facets(); ++facet) {
        if (!counts_[facet])
            continue;
        over_facet(facet, [&](const glm::dvec3& world, double weight) {
            const Vector point = to_mesh_frame(structure_, world);
            const double error = angle_between(reference::shading_direction(mesh_, shading, facet, point),
                                               smooth_.normal(world.x, world.y));
            squares += weight * error * error;
            area += weight;
            largest = std::max(largest, error);
        });
    }
    for (const auto& [ends, facets] : facets_of_)
        if (facets.size() == 2 && counts_[facets[0]] && counts_[facets[1]])
            jump = std::max(jump, largest_jump(ends, facets, shading));
    return {std::sqrt(squares / area) / kDegree, largest / kDegree, jump / kDegree};
}

PatchStudy::Edge PatchStudy::edge_of(uint facet, uint i) const {
    const uint next = i + 1 == polygons_.begins[facet + 1] ? polygons_.begins[facet] : i + 1;
    return std::minmax(polygons_.corners[i], polygons_.corners[next]);
}

// Uniformly over (x, y) on the facet, a hexagon's plane being that of its Newell normal: use(point, weight).
template <typename Use> void PatchStudy::over_facet(uint facet, const Use& use) const {
    constexpr int kSteps = 24;
    std::vector<glm::dvec3> corners;
    glm::dvec3 middle(0);
    for (uint i = polygons_.begins[facet]; i < polygons_.begins[facet + 1]; ++i) {
        corners.push_back(polygons_.vertices[polygons_.corners[i]]);
        middle += corners.back();
    }
    middle /= double(corners.size());
    const Vector normal = reference::vector_at(mesh_.facet_normals, facet);
    for (std::size_t corner = 1; corner + 1 < corners.size(); ++corner) {
        const glm::dvec3 u = corners[corner] - corners[0], v = corners[corner + 1] - corners[0];
        for (int i = 0; i < kSteps; ++i)
            for (int j = 0; i + j < kSteps; ++j)
                for (int upper = 0; upper < (i + j + 1 < kSteps ? 2 : 1); ++upper) {
                    const double third = (upper ? 2 : 1) / 3.0;
                    glm::dvec3 at = corners[0] + (i + third) / kSteps * u + (j + third) / kSteps * v;
                    at.z = middle.z - ((at.x - middle.x) * normal.x + (at.y - middle.y) * normal.y) / normal.z;
                    use(at, std::abs(u.x * v.y - u.y * v.x));
                }
    }
}

double PatchStudy::largest_jump(const Edge& ends, const std::vector<uint>& facets, uint shading) const {
    double jump = 0;
    for (int i = 0; i <= 64; ++i) {
        const glm::dvec3 world = polygons_.vertices[ends.first] +
                                 i / 64.0 * (polygons_.vertices[ends.second] - polygons_.vertices[ends.first]);
        const Vector point = to_mesh_frame(structure_, world);
        jump = std::max(jump, angle_between(reference::shading_direction(mesh_, shading, facets[0], point),
                                            reference::shading_direction(mesh_, shading, facets[1], point)));
    }
    return jump;
}

} // namespace forceshade::study
