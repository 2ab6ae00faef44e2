#include "host/mesh/structure_edges.h"

#include <algorithm>
#include <cmath>

#include "host/reference/vector.h"

namespace forceshade {
namespace {

using layout::uint;
using Vector = reference::Vector<double>;

Vector vector_at(const std::vector<double>& table, std::size_t index) {
    return reference::vector_at<double>(table, index);
}

/// A triangle's edge, filed under the lower place of its ends.
struct FiledEdge {
    uint higher; // the other end
    uint edge;   // 3 * triangle + i
};

/// All edges by lower place, then higher, then number; begins has where each place's edges begin.
struct EdgeFile {
    std::vector<uint> begins;
    std::vector<FiledEdge> edges;
};

/// The corner at which an edge ends.
std::size_t following(std::size_t edge) {
    return edge % 3 == 2 ? edge - 2 : edge + 1;
}

EdgeFile file_edges(const std::vector<uint>& corners, const std::vector<uint>& places) {
    EdgeFile file;
    const auto ends = [&](std::size_t edge) {
        const uint start = places[corners[edge]], end = places[corners[following(edge)]];
        return std::pair{std::min(start, end), std::max(start, end)};
    };
    file.begins.assign(places.size() + 1, 0);
    for (std::size_t edge = 0; edge < corners.size(); ++edge)
        ++file.begins[ends(edge).first + 1];
    for (std::size_t place = 0; place < places.size(); ++place)
        file.begins[place + 1] += file.begins[place];
    std::vector<uint> next(file.begins.begin(), file.begins.end() - 1);
    file.edges.resize(corners.size());
    for (std::size_t edge = 0; edge < corners.size(); ++edge) {
        const auto [lower, higher] = ends(edge);
        file.edges[next[lower]++] = {higher, static_cast<uint>(edge)};
    }
    for (std::size_t place = 0; place < places.size(); ++place)
        std::sort(file.edges.begin() + file.begins[place], file.edges.begin() + file.begins[place + 1],
                  [](const FiledEdge& one, const FiledEdge& other) {
                      return one.higher < other.higher || (one.higher == other.higher && one.edge < other.edge);
                  });
    return file;
}

/// Calls use(begin, end) with all edges between one pair of places, pair by pair.
template <typename Use> void for_each_bundle(const EdgeFile& file, const Use& use) {
    for (std::size_t place = 0; place + 1 < file.begins.size(); ++place) {
        const FiledEdge* end = file.edges.data() + file.begins[place + 1];
        for (const FiledEdge* begin = file.edges.data() + file.begins[place]; begin != end;) {
            const FiledEdge* next = begin;
            while (next != end && next->higher == begin->higher)
                ++next;
            use(begin, next);
            begin = next;
        }
    }
}

/// The edges of one and the same pair of places.
void connect(const FiledEdge* begin, const FiledEdge* end, MeshParts& parts, MeshReals<double>& reals) {
    if (end - begin == 1) {
        parts.triangle_neighbours[begin->edge] = layout::kMeshBorder;
        return;
    }
    if (end - begin == 2 && begin->edge / 3 != begin[1].edge / 3) {
        parts.triangle_neighbours[begin->edge] = begin[1].edge / 3;
        parts.triangle_neighbours[begin[1].edge] = begin->edge / 3;
        return;
    }
    Vector sum(0.0);
    for (const FiledEdge* edge = begin; edge != end; ++edge)
        sum += vector_at(reals.triangle_normals, edge->edge / 3);
    const auto entry = static_cast<uint>(reals.edge_pseudonormals.size() / 3);
    reals.edge_pseudonormals.insert(reals.edge_pseudonormals.end(), {sum.x, sum.y, sum.z});
    for (const FiledEdge* edge = begin; edge != end; ++edge)
        parts.triangle_neighbours[edge->edge] = layout::kMeshManyBit | entry;
}

/// The angle between two edges, good for needles too.
double angle_between(const Vector& u, const Vector& v) {
    const Vector normal = reference::cross(u, v);
    return std::atan2(std::sqrt(reference::dot(normal, normal)), reference::dot(u, v));
}

} // namespace

void connect_edges(MeshParts& parts, MeshReals<double>& reals, const std::vector<uint>& places) {
    parts.triangle_neighbours.resize(parts.triangle_corners.size());
    for_each_bundle(file_edges(parts.triangle_corners, places),
                    [&](const FiledEdge* begin, const FiledEdge* end) { connect(begin, end, parts, reals); });
}

std::vector<uint> find_rims(const MeshParts& parts, const std::vector<uint>& places) {
    std::vector<uint> rims;
    const std::vector<uint>& corners = parts.triangle_corners;
    for_each_bundle(file_edges(corners, places), [&](const FiledEdge* begin, const FiledEdge* end) {
        long surplus = 0;
        for (const FiledEdge* edge = begin; edge != end; ++edge)
            surplus += places[corners[edge->edge]] == edge->higher ? -1 : 1;
        const uint start = corners[begin->edge], stop = corners[following(begin->edge)];
        if (surplus != 0 && places[start] != places[stop])
            rims.insert(rims.end(), {start, stop, static_cast<uint>(std::abs(surplus))});
    });
    return rims;
}

void sum_pseudonormals(const MeshParts& parts, MeshReals<double>& reals, const std::vector<uint>& places) {
    std::vector<double>& sums = reals.vertex_pseudonormals;
    sums.assign(reals.vertices.size(), 0.0);
    for (std::size_t triangle = 0; triangle < parts.triangle_facets.size(); ++triangle) {
        const uint* corners = &parts.triangle_corners[3 * triangle];
        Vector at[3];
        for (std::size_t i = 0; i < 3; ++i)
            at[i] = vector_at(reals.vertices, corners[i]);
        const Vector normal = vector_at(reals.triangle_normals, triangle);
        for (std::size_t i = 0; i < 3; ++i) {
            const double angle = angle_between(at[(i + 1) % 3] - at[i], at[(i + 2) % 3] - at[i]);
            double* sum = &sums[3 * std::size_t(places[corners[i]])];
            sum[0] += angle * normal.x;
            sum[1] += angle * normal.y;
            sum[2] += angle * normal.z;
        }
    }
    for (std::size_t vertex = 0; vertex < places.size(); ++vertex)
        std::copy_n(&sums[3 * std::size_t(places[vertex])], 3, &sums[3 * vertex]);
}

bool has_firm_pseudonormals(const MeshParts& parts, const MeshReals<double>& reals) {
    constexpr double kFirm = 0x1p-14; // of the square of the length
    for (std::size_t vertex = 0; vertex < reals.vertex_pseudonormals.size() / 3; ++vertex) {
        const Vector sum = vector_at(reals.vertex_pseudonormals, vertex);
        if (!(reference::dot(sum, sum) > kFirm))
            return false;
    }
    for (std::size_t edge = 0; edge < parts.triangle_neighbours.size(); ++edge) {
        const uint across = parts.triangle_neighbours[edge];
        if ((across & layout::kMeshManyBit) != 0) // a border too
            return false;
        const Vector sum = vector_at(reals.triangle_normals, edge / 3) + vector_at(reals.triangle_normals, across);
        if (!(reference::dot(sum, sum) > kFirm))
            return false;
    }
    return true;
}

} // namespace forceshade
