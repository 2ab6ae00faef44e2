#include "host/referee/proxy_sides.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include <fmt/format.h>

#include "host/mesh/structure.h"
#include "host/norm.h"
#include "host/prepare/prepared_case.h"
#include "host/program.h"
#include "host/reference/god_object.h"

namespace forceshade {

namespace {

constexpr std::uint64_t kSamples = std::uint64_t(1) << 14; // looked at, about: half a second
constexpr std::uint64_t kLoopBudget = 1'000'000;           // triangles that loops may look at: some seconds
constexpr double kFurther = 8;  // how far from a proxy in contact its side is told, in tolerances
constexpr double kWhole = 1e-2; // how far a winding number may be from a whole one: the tree's are good to 1e-4

using Point = reference::Vector<double>;

std::optional<int> whole(double winding) {
    const double nearest = std::nearbyint(winding);
    return std::abs(winding - nearest) < kWhole ? std::optional(static_cast<int>(nearest)) : std::nullopt;
}

} // namespace

// The mesh as the tree and as the brute referee see it. Places are in the mesh's frame.
template <typename T> struct ProxySides<T>::Surface {
    Surface(const Mesh& polygons, const MeshStructure& with_winding)
        : mesh(polygons), structure(with_winding), tables(make_mesh_tables<double>(structure, 0)),
          referee(polygons, {}) {
        law.features.surface = layout::kSurfaceMesh;
        law.mesh = tables.view();
    }

    // No side can be told nearer to the surface than this.
    double tolerance(const Point& local, const glm::dvec3& world) const {
        constexpr double kEpsilon = std::numeric_limits<T>::epsilon();
        const double written = std::max({std::abs(world.x), std::abs(world.y), std::abs(world.z)}) / structure.scale;
        const double touch = 16 * kEpsilon * (1 + reference::largest_coordinate(local)); // touch_tolerance()
        const double placed =
            4 * kEpsilon * (1 + reference::largest_coordinate(local) + written); // probe, vertices, proxy
        return 2 * double(reference::Skin<T>::kWidth) + touch + placed;
    }

    std::optional<int> by_tree(const Point& place, double nearest) const {
        const auto found = reference::nearest(law.mesh, place);
        return norm(found.offset) > nearest ? whole(reference::winding_number(law.mesh, place)) : std::nullopt;
    }

    std::optional<int> by_loops(const Point& place, double nearest) const {
        const glm::dvec3 world = to_world(place);
        return double(referee.nearest(world).distance) > nearest * structure.scale
                   ? whole(double(referee.winding_number(world)))
                   : std::nullopt;
    }

    // Whether facets around a proxy face both ways along a direction by more than one part in kFurther.
    bool faces_both_ways(const Point& proxy, const Point& towards, double reach) const {
        bool ahead = false, back = false;
        for (const brute::Answer& answer : referee.all_at(to_world(proxy), reach * structure.scale)) {
            if (answer.facet == layout::kNoFacet)
                continue;
            const glm::dvec3& normal = mesh.facet_normals[answer.facet];
            const double rate = reference::dot(normal, towards);
            ahead = ahead || rate > 1 / kFurther;
            back = back || rate < -1 / kFurther;
        }
        return ahead && back;
    }

    Point to_frame(const glm::dvec3& world) const { return (world - structure.centre) / structure.scale; }
    glm::dvec3 to_world(const Point& local) const { return structure.centre + structure.scale * local; }

    const Mesh& mesh;
    MeshStructure structure;
    MeshTables<double> tables;
    layout::Law<double> law{};
    brute::MeshReferee referee;
};

template <typename T> struct ProxySides<T>::Path {
    std::optional<int> side; // the winding number where the path is to be
    bool other = false;      // loops over all triangles have told that it is elsewhere
    T last[3]{};             // m: the position of its last sample
};

template <typename T> struct ProxySides<T>::Sample {
    std::size_t path, step;
    glm::dvec3 probe, proxy; /* m */
    bool touching;
};

template <typename T>
ProxySides<T>::ProxySides(const PreparedCase& prepared, std::uint64_t samples, bool closed_loop)
    : every_(std::max<std::uint64_t>(1, samples / kSamples)), closed_loop_(closed_loop) {
    if (!prepared.images.mesh)
        return;
    MeshStructure structure = prepared.images.mesh->structure;
    if (!structure.winding)
        structure.winding = make_winding(structure);
    count_.closed = structure.winding->rims.empty();
    if (!count_.closed)
        return;
    affordable_ = std::max<std::uint64_t>(1, kLoopBudget / structure.triangles());
    brute_every_ = samples / every_ / affordable_ + 1;
    auto surface = std::make_unique<Surface>(prepared.images.mesh->mesh, structure);
    surface->law.features.inside = prepared.one.scene.surface.mesh.inside == InsideTest::winding
                                       ? layout::kInsideWinding
                                       : layout::kInsidePseudonormal;
    surface_ = std::move(surface);
}

template <typename T> ProxySides<T>::~ProxySides() = default;

template <typename T> void ProxySides<T>::check(const PathRows<T>& rows) {
    if (!surface_)
        return;
    if (rows.step_first == 0)
        paths_.assign(rows.path_count, {});
    for (std::size_t path = 0; path < rows.path_count; ++path) {
        check_interrupt();
        const std::size_t samples = rows.samples(path);
        for (std::size_t i = 0; i < samples; ++i) {
            const std::size_t at = path * rows.pitch + i, step = rows.step_first + i;
            const T* const position = &rows.position[3 * at];
            const bool touching = rows.facet[at] != layout::kNoFacet;
            const bool stands = step > 0 && std::memcmp(position, paths_[path].last, 3 * sizeof(T)) == 0;
            std::copy_n(position, 3, paths_[path].last);
            const bool wanted =
                step == 0 || step + 1 == rows.steps[path] || (rows.path_first + path + step) % every_ == 0;
            // A probe that left its bound stays where it was, without a proxy.
            if (!wanted || (closed_loop_ && stands && !touching))
                continue;
            const T* const proxy = &rows.proxy[3 * at];
            check_sample({rows.path_first + path,
                          step,
                          {position[0], position[1], position[2]},
                          {proxy[0], proxy[1], proxy[2]},
                          touching},
                         paths_[path]);
        }
    }
}

// A path begins where its probe is; behind the surface, at the nearest place in front of it.
template <typename T> void ProxySides<T>::begin(const Sample& sample, Path& path) {
    const Point probe = surface_->to_frame(sample.probe);
    path.side = surface_->by_tree(probe, surface_->tolerance(probe, sample.probe));
    const auto found = reference::nearest(surface_->law.mesh, probe);
    if (path.side && reference::is_inside(surface_->law, found, probe))
        *path.side += reference::inside_by_pseudonormal(surface_->law.mesh, found) ? -1 : 1;
}

template <typename T> void ProxySides<T>::check_sample(const Sample& sample, Path& path) {
    const Surface& surface = *surface_;
    const Point proxy = surface.to_frame(sample.proxy);
    if (!std::isfinite(norm(proxy)) || !std::isfinite(norm(Point(sample.probe))))
        return;
    if (sample.step == 0)
        begin(sample, path);
    const double tolerance = surface.tolerance(proxy, sample.probe);
    Point place = proxy, towards(0.0);
    double nearest = tolerance;
    if (sample.touching) {
        towards = surface.to_frame(sample.proxy) - surface.to_frame(sample.probe);
        const double depth = norm(towards);
        towards = depth > tolerance ? towards / depth : Point(0.0); // less deep, rounding may turn it round
        place = proxy + kFurther * tolerance * towards;
        nearest = 2 * tolerance;
    }
    const bool chosen = count_.samples++ % brute_every_ == 0;
    std::optional<int> side = surface.by_tree(place, nearest);
    // Of a path that fell, the first sample; of too many paths, not of all.
    const bool doubtful = side && path.side && *side != *path.side && !path.other;
    const bool looks = chosen || (doubtful && count_.brute < 2 * affordable_);
    if (looks) {
        ++count_.brute;
        side = surface.by_loops(place, nearest);
    }
    const bool differs = side && path.side && *side != *path.side;
    const bool narrow = differs && sample.touching && !path.other &&
                        (!looks || surface.faces_both_ways(proxy, towards, (kFurther + 1) * tolerance));
    if (!side || narrow) {
        ++count_.near;
        return;
    }
    if (!path.side)
        path.side = side;
    if (!differs)
        return;
    path.other = true;
    ++count_.other;
    if (count_.first.empty())
        count_.first =
            fmt::format("path {}, step {}: the proxy at ({:.9g}, {:.9g}, {:.9g}) m is on the other side of "
                        "the surface than where the path began (winding number {}, not {})",
                        sample.path, sample.step, sample.proxy.x, sample.proxy.y, sample.proxy.z, *side, *path.side);
}

template class ProxySides<float>;
template class ProxySides<double>;

} // namespace forceshade
