// A god-object (L6) on a soup or a solid: every piece of its way is held against all triangles in exact arithmetic, it
// keeps its skin, is the same with lists of obstacles, and comes to rest on its side of a closed surface.
#include <memory>
#include <numbers>
#include <optional>

#include <glm/geometric.hpp>

#include "host/error.h"
#include "host/mesh/findings.h"
#include "host/mesh/structure.h"
#include "host/referee/referee.h"
#include "host/reference/god_object.h"
#include "tests/fuzz/meshes.h"
#include "tests/mesh/god_object_referee.h"
#include "tests/mesh/god_object_walks.h"

namespace forceshade {
namespace {

using fuzz::Bytes;
using fuzz::require;
using walks::kLeastGap;
using walks::same_bits;
using walks::wide;

constexpr unsigned kSteps = 12;
/// The scale of a frame from which most of a mesh, which lies within 2 of the origin, is seen from far.
constexpr double kFar = 64;

/// The next probe, in the mesh's frame: on corners, edges, along them, beside them, or anywhere.
class Course {
public:
    Course(Bytes& bytes, const MeshStructure& structure) : bytes_(bytes), structure_(structure) {}

    glm::dvec3 next() {
        const glm::dvec3 here = corner(), there = corner();
        switch (bytes_.below(8)) {
        case 0:
            at_ = here + beside();
            break;
        case 1:
            at_ = 0.5 * (here + there) + beside();
            break;
        case 2:
            at_ += bytes_.number() * (there - here);
            break;
        case 3:
            at_ += beside();
            break;
        case 4: // through a place
            at_ = at_ + 2.0 * (here + beside() - at_);
            break;
        case 5:
            at_ = here + bytes_.number() * (there - here) + beside();
            break;
        case 6:
            at_ = 0.5 * here + beside();
            break;
        default:
            at_ = glm::dvec3(bytes_.number(), bytes_.number(), bytes_.number());
        }
        if (!(glm::length(at_) < 1e3))
            at_ = glm::dvec3(1.5);
        return at_;
    }

private:
    glm::dvec3 corner() {
        const std::size_t vertex = 3 * bytes_.below(std::min<std::size_t>(256, structure_.reals->vertices.size() / 3));
        return {structure_.reals->vertices[vertex], structure_.reals->vertices[vertex + 1],
                structure_.reals->vertices[vertex + 2]};
    }
    /// Nothing, or 1e-12 to 1 sizes.
    glm::dvec3 beside() {
        const std::uint8_t size = bytes_.byte();
        if (size % 4 == 0)
            return glm::dvec3(0);
        const glm::dvec3 direction(static_cast<double>(bytes_.byte()) - 127.5,
                                   static_cast<double>(bytes_.byte()) - 127.5,
                                   static_cast<double>(bytes_.byte()) - 127.5);
        return std::pow(10.0, -12 + static_cast<double>(size / 20)) * glm::normalize(direction);
    }

    Bytes& bytes_;
    const MeshStructure& structure_;
    glm::dvec3 at_{1.5, 1.25, 1.75};
};

/// How often a closed surface goes round a place of the frame: solid angles over 4 pi (van Oosterom & Strackee 1983).
double winding_at(const brute::Triangles& triangles, const glm::dvec3& place) {
    using Point = glm::vec<3, long double>;
    long double sum = 0;
    for (const auto& corners : triangles.corners) {
        const Point a = Point(corners[0]) - Point(place), b = Point(corners[1]) - Point(place),
                    c = Point(corners[2]) - Point(place);
        const long double u = glm::length(a), v = glm::length(b), w = glm::length(c);
        sum += 2 * std::atan2(glm::dot(a, glm::cross(b, c)),
                              u * v * w + glm::dot(a, b) * w + glm::dot(b, c) * u + glm::dot(c, a) * v);
    }
    return static_cast<double>(sum / (4 * std::numbers::pi_v<long double>));
}

/// Whether no corner lies in front of any triangle.
bool is_convex(const brute::Triangles& triangles) {
    for (const auto& plane : triangles.corners) {
        const glm::dvec3 a(plane[0]), normal = glm::cross(glm::dvec3(plane[1]) - a, glm::dvec3(plane[2]) - a);
        for (const auto& corners : triangles.corners)
            for (std::size_t i = 0; i < 3; ++i)
                if (glm::dot(normal, glm::dvec3(corners[i]) - a) > 1e-9)
                    return false;
    }
    return true;
}

/// Where a god-object rests, nothing of its pull towards the probe is left along the planes of its contact.
template <typename T>
void check_rest(const reference::GodObjectContact<T>& contact, const glm::dvec3& proxy, const glm::dvec3& probe,
                double skin, unsigned step) {
    const glm::dvec3 pull = probe - proxy;
    glm::dvec3 left = pull;
    const glm::dvec3 one = wide(contact.normals[0]);
    if (contact.count == 1)
        left -= glm::dot(left, one) * one;
    if (contact.count == 2) {
        const glm::dvec3 line = glm::cross(one, wide(contact.normals[1]));
        left = glm::length(line) > 0.1 ? glm::dot(left, line) / glm::dot(line, line) * line : glm::dvec3(0);
    }
    require(contact.count > 2 || glm::length(left) <= 64 * skin + 0.05 * glm::length(pull),
            "step {}: {} of a pull of {} is left at {} planes", step, glm::length(left), glm::length(pull),
            contact.count);
}

template <typename T> void walk(const MeshStructure& structure, bool closed, bool within, Bytes& bytes) {
    MeshTables<T> tables = make_mesh_tables<T>(structure, 1.0);
    const layout::MeshView<T> view = tables.view();
    MeshTables<T> listed = tables;
    find_obstacles(listed, 1);
    const layout::MeshView<T> with_lists = listed.view();
    const brute::Triangles triangles = brute::Triangles::of(view.vertices, view.triangle_corners);
    const brute::TriangleGrid grid(triangles);
    const auto around = std::make_unique<reference::Neighbourhood<T>>();
    const auto around_lists = std::make_unique<reference::Neighbourhood<T>>();
    reference::GodObject<T> state, other;
    Course course(bytes, structure);
    std::optional<double> side;
    const bool convex = closed && is_convex(triangles);
    const double skin = double(reference::Skin<T>::kWidth);
    const auto gap = [&] { return std::sqrt(double(reference::nearest(view, state.proxy).square)) / skin; };
    for (unsigned step = 0; step < kSteps && (step == 0 || !bytes.empty()); ++step) {
        glm::vec<3, T> probe(course.next());
        if (within && step == 0) { // half a skin from a triangle, on either side
            const reference::Triangle<T> one =
                reference::triangle_at(view, static_cast<layout::uint>(bytes.below(256) % view.triangle_facets.size()));
            probe = (one.corners[0] + one.corners[1] + one.corners[2]) / T(3) +
                    (bytes.below(2) ? T(skin / 2) : T(-skin / 2)) * one.normal;
        }
        unsigned crossed = 0;
        const auto trace = [&](const glm::vec<3, T>& from, const glm::vec<3, T>& to) {
            crossed += grid.touches(wide(from), wide(to));
        };
        const auto contact = reference::update(view, state, *around, probe, trace);
        const auto listed_contact = reference::update(with_lists, other, *around_lists, probe);
        require(same_bits(contact.proxy, listed_contact.proxy) && same_bits(state.proxy, other.proxy) &&
                    contact.count == listed_contact.count && contact.substeps == listed_contact.substeps,
                "step {}: lists of obstacles change something", step);
        // Where there is no room for a skin, a path cannot begin with one.
        if (step == 0 && gap() < 1 - 1e-3)
            return;
        require(crossed == 0, "step {}: {} pieces of the way cross a triangle", step, crossed);
        // Between several walls it may creep on for more rounds than an update has; then `finished` says so.
        require(contact.finished || !closed, "step {}: it does not come to rest", step);
        // Seen from far, whole folds are thinner than the skin.
        require(gap() > kLeastGap || structure.scale > kFar, "step {}: {} skins from the mesh", step, gap());
        if (closed && contact.finished && !contact.touching)
            require(glm::length(wide(state.proxy) - wide(probe)) <= 1e3 * skin * (1 + glm::length(wide(probe))),
                    "step {}: in the open, it ends {} skins from the probe, {} from the mesh{}", step,
                    glm::length(wide(state.proxy) - wide(probe)) / skin, gap(),
                    grid.touches(wide(state.proxy), wide(probe)) ? ", which stands between" : "");
        if (closed) {
            if (step == 0 && double(reference::nearest(view, probe).square) > skin * skin / 64)
                side = winding_at(triangles, wide(probe)); // it begins where the probe is
            const double now = winding_at(triangles, wide(state.proxy));
            require(std::abs(now - side.value_or(now)) < 0.5, "step {}: the winding number was {}, it is {}", step,
                    side.value_or(now), now);
            side = now;
            if (contact.finished && contact.touching && glm::length(wide(probe)) < 4)
                check_rest(contact, wide(state.proxy), wide(probe), skin, step);
            // Within a convex room one place is nearest to the probe.
            if (convex && now > 0.5 && glm::length(wide(probe)) < 4) {
                const double depth = winding_at(triangles, wide(probe)) > 0.5
                                         ? 0
                                         : std::sqrt(double(reference::nearest(view, probe).square));
                const double distance = glm::length(wide(probe) - wide(state.proxy));
                require(distance <= depth + 64 * skin, "step {}: it rests {} from the probe where {} is possible", step,
                        distance, depth);
            }
        }
    }
}

} // namespace
} // namespace forceshade

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace forceshade;
    Bytes bytes(data, size);
    const std::uint8_t kind = bytes.byte();
    const PolygonSoup soup = kind & 2 ? fuzz::take_solid(bytes) : fuzz::take_soup(bytes);
    try {
        const MeshFindings findings = inspect(soup);
        refuse_if_meaningless(findings, "a mesh");
        const Mesh mesh = prepare_mesh(soup, {}, VertexNormals::plain);
        MeshStructure structure = build_structure(mesh, {.threads = 1});
        if (is_solid(findings))
            assume_solid(structure);
        // Of what is flat to within rounding, or seen from too far, no side can be told.
        const bool solid = is_solid(findings) && brute::choose_triangles(mesh).noise == 0 && structure.scale <= kFar;
        if (kind & 1)
            walk<double>(structure, solid, (kind & 4) != 0, bytes);
        else
            walk<float>(structure, solid, (kind & 4) != 0, bytes);
    } catch (const UsageError&) {
    }
    return 0;
}
