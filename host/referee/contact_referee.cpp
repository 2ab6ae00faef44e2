#include "host/referee/contact_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <glm/mat3x3.hpp>

#include "host/norm.h"
#include "host/program.h"
#include "host/reference/mesh_cast.h"

namespace forceshade {

namespace {

constexpr std::uint64_t kLoopBudget = 1'000'000; // triangles that loops may look at: some seconds
constexpr double kFurther = 8;                   // how far from a proxy in contact its side is checked, in tolerances
constexpr double kFew = 4;                       // tolerances that explain a growth, a residual, a force
constexpr double kSlant = 1.0 / 64;              // of a force's direction

using Point = reference::Vector<double>;

// The structure's vertices as an engine in T has them. Through a table: g++ 12 at -O2 folds conversions there and back.
template <typename T> std::vector<double> rounded_vertices(const MeshStructure& structure) {
    const MeshTables<T> tables = make_mesh_tables<T>(structure, 0);
    const auto vertices = tables.view().vertices;
    return {vertices.begin(), vertices.end()};
}

} // namespace

void ContactCount::add(const ContactCount& more) {
    mesh = mesh || more.mesh;
    closed = closed || more.closed;
    samples += more.samples;
    windings += more.windings;
    brute += more.brute;
    near += more.near;
    grew += more.grew;
    unbalanced += more.unbalanced;
    dropped += more.dropped;
    phantoms += more.phantoms;
    other += more.other;
    if (first.empty())
        first = more.first;
}

template <typename T> struct ContactReferee<T>::Surface : ContactSurface {
    Surface(const PreparedCase& prepared, std::uint64_t samples)
        : ContactSurface(prepared.images.mesh->mesh, prepared.images.mesh->structure,
                         rounded_vertices<T>(prepared.images.mesh->structure)),
          by_winding(prepared.one.scene.surface.mesh.inside == InsideTest::winding),
          affordable(std::max<std::uint64_t>(1, kLoopBudget / prepared.images.mesh->structure.triangles())),
          brute_every(samples / affordable + 1) {}

    // What skin and rounding make of a place; the side is not defined nearer to the surface.
    // `probe`, m: from the scene's origin.
    double tolerance(const Point& local, const glm::dvec3& probe) const {
        constexpr double kEpsilon = std::numeric_limits<T>::epsilon();
        const double written = std::max({std::abs(probe.x), std::abs(probe.y), std::abs(probe.z)}) / scale();
        const double touch = 16 * kEpsilon * (1 + reference::largest_coordinate(local));
        const double placed = 4 * kEpsilon * (1 + reference::largest_coordinate(local) + written);
        return 2 * double(reference::Skin<T>::kWidth) + touch + placed;
    }

    bool by_winding;
    std::uint64_t affordable;  // samples that loops may look at
    std::uint64_t brute_every; // of the samples, those that they look at
};

template <typename T> struct ContactReferee<T>::Sample {
    std::size_t path, step;
    glm::dvec3 probe_place, proxy_place; /* m, from the scene's origin */
    layout::uint facet;
    Point probe{0}, proxy{0}; // in the frame
    double tolerance = 0;

    bool touching() const { return facet != layout::kNoFacet; }
};

template <typename T> struct ContactReferee<T>::Path {
    std::optional<int> side;        // the winding number where the path is to be
    std::optional<int> there;       // the winding number at the last place where it is known
    Point place{0};                 // that place
    bool other = false;             // loops over all triangles have found the path elsewhere
    T last[3]{};                    // m: the position of its last sample, checked or not
    std::optional<Sample> before{}; // the last one
    bool lost = false;              // its proxy is elsewhere
};

// One sample of a path, judged.
template <typename T> class ContactReferee<T>::Judge {
public:
    Judge(const Surface& surface, Path& path, const Sample& sample, ContactCount& count)
        : surface_(surface), path_(path), at_(sample), count_(count), pull_(at_.probe - at_.proxy), depth_(norm(pull_)),
          margin_(kFew * at_.tolerance) {}

    void judge() {
        ++count_.samples;
        if (!path_.before && surface_.closed())
            path_.side = surface_.side_of_start(at_.probe, at_.tolerance, surface_.by_winding);
        if (surface_.closed())
            check_side();
        if (at_.touching() && depth_ > margin_)
            check_contact();
        if (path_.before)
            check_growth(*path_.before);
        count_.near += doubtful_;
        path_.before = at_;
        path_.lost = lost_;
    }

private:
    void check_side() {
        Point place = at_.proxy, towards(0.0);
        double nearest = at_.tolerance;
        const bool chosen = count_.samples % surface_.brute_every == 0;
        if (at_.touching()) {
            if (depth_ > at_.tolerance)
                towards = -pull_ / depth_; // less deep, rounding may turn it round
            else if (!chosen) {
                doubtful_ = true;
                return;
            }
            place = at_.proxy + kFurther * at_.tolerance * towards;
            nearest = 2 * at_.tolerance;
        }
        std::optional<int> side;
        if (path_.there && surface_.meets(path_.place, place) == Meets::no) {
            if (path_.there == path_.side || surface_.distance(place) > nearest)
                side = path_.there;
        } else {
            ++count_.windings;
            side = surface_.side_by_tree(place, nearest);
        }
        // Of a path that fell, the first sample; of too many paths, not of all.
        const bool suspected = side && path_.side && *side != *path_.side && !path_.other;
        const bool looks = chosen || (suspected && count_.brute < 2 * surface_.affordable);
        if (looks) {
            ++count_.brute;
            side = surface_.side_by_loops(place, nearest);
        }
        if (!side) {
            doubtful_ = true;
            return;
        }
        path_.there = side;
        path_.place = place;
        if (!path_.side && at_.touching() && (!is_square_to(towards) || is_in_pocket(towards, side))) {
            doubtful_ = true;
            return;
        }
        if (!path_.side)
            path_.side = side;
        if (*side == *path_.side)
            return;
        if (at_.touching() && !path_.other && (!looks || is_in_pocket(towards, path_.side))) {
            doubtful_ = true;
            return;
        }
        path_.other = lost_ = true;
        note(at_.touching() ? count_.other : count_.dropped,
             fmt::format("is on the other side of the surface than where the path began (winding number {}, not {})",
                         *side, *path_.side));
    }

    // Whether a place next to a proxy in contact may be on another side than the proxy a skin off the surface is:
    // facets there face both ways, or another one is near.
    bool is_in_pocket(const Point& towards, std::optional<int> side) {
        return surface_.face_both_ways(at_.proxy, towards, (kFurther + 1) * at_.tolerance) ||
               surface_.meets(at_.proxy + at_.tolerance * towards,
                              at_.proxy + kFurther * kFurther * at_.tolerance * towards) != Meets::no ||
               (surface_.facing(side) == 0 && is_in_crossing());
    }

    // Whether all facets at a proxy are square to the force: where others are, which sector it is in is not known.
    bool is_square_to(const Point& towards) const {
        const std::vector<std::uint32_t> here = surface_.triangles_at(at_.proxy, margin_, margin_);
        return !here.empty() && std::ranges::all_of(here, [&](std::uint32_t triangle) {
            return std::abs(reference::dot(surface_.normal(triangle), towards)) > 1 - kSlant;
        });
    }

    // Where facets cross, a force between them may point out of the narrow sector where its proxy is. It says on which
    // side of two or three facets the proxy is: whether a place between those is where the path is.
    bool is_in_crossing() {
        std::vector<std::uint32_t> here = surface_.crossing(surface_.triangles_at(at_.proxy, margin_, margin_));
        here.resize(std::min<std::size_t>(here.size(), 6));
        for (std::size_t i = 0; i < here.size(); ++i)
            for (std::size_t j = i + 1; j < here.size(); ++j)
                for (std::size_t k = j; k < here.size(); ++k) {
                    const Point one = surface_.normal(here[i]), other = surface_.normal(here[j]);
                    const bool two = k == j;
                    if (is_in_sector({one, other, two ? reference::cross(one, other) : surface_.normal(here[k])}, two))
                        return true;
                }
        return false;
    }

    // The place is equally far from the facets of these normals; `two`: the third is along the line of the others. A
    // facet that takes no share of the force may hold the proxy from either side.
    bool is_in_sector(const glm::dmat3& normals, bool two) {
        if (!(std::abs(glm::determinant(normals)) > 1e-6))
            return false;
        const glm::dmat3 dual = glm::inverse(normals);
        const Point shares = dual * pull_;
        if (two && std::abs(shares.z) * norm(normals[2]) > margin_ + kSlant * depth_)
            return false;
        const int facets = two ? 2 : 3;
        for (unsigned turned = 0; turned < 1u << facets; ++turned) {
            Point inwards(0);
            bool possible = true;
            for (int i = 0; i < facets; ++i) {
                const bool turn = (turned >> i & 1u) != 0;
                possible = possible && (!turn || std::abs(shares[i]) <= margin_);
                inwards[i] = (shares[i] > 0) != turn ? -1 : 1;
            }
            const Point place = at_.proxy + kFurther / 2 * at_.tolerance * (inwards * dual);
            if (!possible || surface_.side_by_tree(place, at_.tolerance) != path_.side)
                continue;
            ++count_.brute;
            if (surface_.side_by_loops(place, at_.tolerance) == path_.side)
                return true;
        }
        return false;
    }

    void check_contact() {
        const double allowed = margin_ + kSlant * depth_;
        const int facing = surface_.facing(path_.other ? std::nullopt : path_.side);
        if (const auto face = surface_.face_at(at_.facet, at_.proxy, margin_)) {
            const Point normal = surface_.normal(*face);
            const double rate = reference::dot(normal, pull_);
            if (norm(pull_ - rate * normal) <= allowed && (facing == 0 || facing * rate < 0)) {
                // The face stands between proxy and probe, unless the proxy came from where the probe is.
                check_course();
                return;
            }
        }
        const std::vector<std::uint32_t> here = surface_.triangles_at(at_.proxy, margin_, margin_);
        if (rests_on(here, facing, allowed)) {
            check_course();
            return;
        }
        if (check_course() || check_sight(here))
            return;
        if (rests_on_both(here, facing, allowed)) {
            doubtful_ = true;
            return;
        }
        note(count_.unbalanced, fmt::format("has a force {:.3g} of its size off the normals of the facets there",
                                            off_normals(here, facing) / depth_));
    }

    // Whether the force is along normals that may constrain a proxy together. Of a mesh that is not a solid, all its
    // facets' fronts face the proxy, or all their backs.
    bool rests_on(const std::vector<std::uint32_t>& triangles, int facing, double allowed) const {
        for (const int side : {1, -1})
            if ((facing == 0 || facing == side) &&
                surface_.residual(pull_, triangles, side, false, at_.tolerance) <= allowed)
                return true;
        return false;
    }

    double off_normals(const std::vector<std::uint32_t>& triangles, int facing) const {
        return surface_.residual(pull_, triangles, facing, true, at_.tolerance);
    }

    // Whether any facets at the proxy explain the force, or others of a narrow corner that it is in.
    bool rests_on_both(const std::vector<std::uint32_t>& here, int facing, double allowed) const {
        if (off_normals(here, facing) <= allowed)
            return true;
        for (double reach = 8 * margin_; reach < 1; reach *= 8) {
            const std::vector<std::uint32_t> around = surface_.triangles_at(at_.proxy, reach, margin_);
            if (kFew * surface_.kept_off(around, facing, at_.tolerance, at_.tolerance) * 8 >= reach &&
                off_normals(around, facing) <= allowed)
                return true;
        }
        return false;
    }

    // A proxy that was at a free probe, and sees the new one, goes there.
    bool check_course() {
        if (!path_.before || path_.before->touching() || path_.lost)
            return false;
        const Point& last = path_.before->probe;
        const double aside = 2.5 * std::max(at_.tolerance, path_.before->tolerance);
        if (surface_.meets(last, at_.probe) != Meets::no || !surface_.is_clear(last, at_.probe, aside) ||
            surface_.distance(last) <= 2 * aside || surface_.distance(at_.probe) <= 2 * aside)
            return false;
        note_phantom("nothing stands between the last probe and this one");
        return true;
    }

    // A proxy without a balanced force that sees the probe, from some place around it where the surface leaves room.
    bool check_sight(const std::vector<std::uint32_t>& here) {
        if (surface_.distance(at_.probe) <= 2 * margin_ || (surface_.closed() && !surface_.crossing(here).empty()))
            return false; // of several sectors with the path's winding number it may be in another
        std::vector<Point> off{-pull_ / depth_};
        for (std::size_t i = 0; i < std::min<std::size_t>(here.size(), 8); ++i)
            for (const double way : {1.0, -1.0})
                off.push_back(way * surface_.normal(here[i]));
        for (const Point& direction : off) {
            const Point from = at_.proxy + kFurther * at_.tolerance * direction;
            if (reference::dot(direction, pull_) > 0 || surface_.distance(from) <= margin_ ||
                !surface_.is_clear(from, at_.probe, 2.5 * at_.tolerance))
                continue;
            if (surface_.closed() && (!path_.side || surface_.side_by_tree(from, at_.tolerance) != path_.side))
                continue;
            note_phantom("nothing stands between it and the probe");
            return true;
        }
        return false;
    }

    void check_growth(const Sample& before) {
        const double tolerance = std::max(at_.tolerance, before.tolerance);
        const double growth = depth_ - norm(at_.probe - before.proxy);
        if (!(growth > kFew * tolerance))
            return;
        if (before.touching()) {
            const auto around = surface_.triangles_at(before.proxy, 2 * growth, kFew * tolerance);
            const int facing = surface_.facing(path_.other ? std::nullopt : path_.side);
            if (growth <= kFew * (tolerance + surface_.kept_off(around, facing, tolerance, tolerance))) {
                doubtful_ = true;
                return;
            }
        }
        note(count_.grew,
             fmt::format("is {:.9g} m further from the probe than the last proxy was", growth * surface_.scale()));
    }

    void note_phantom(const char* why) {
        note(count_.phantoms, fmt::format("has a force {:.9g} m deep, but {}", depth_ * surface_.scale(), why));
    }

    void note(std::uint64_t& counter, const std::string& what) {
        ++counter;
        const glm::dvec3 place = surface_.origin() + at_.proxy_place;
        if (count_.first.empty())
            count_.first = fmt::format("path {}, step {}: the proxy at ({:.9g}, {:.9g}, {:.9g}) m {}", at_.path,
                                       at_.step, place.x, place.y, place.z, what);
    }

    const Surface& surface_;
    Path& path_;
    const Sample& at_;
    ContactCount& count_;
    Point pull_;
    double depth_, margin_;
    bool doubtful_ = false;
    bool lost_ = false; // the proxy is elsewhere
};

template <typename T>
ContactReferee<T>::ContactReferee(const PreparedCase& prepared, std::uint64_t samples, bool closed_loop)
    : closed_loop_(closed_loop) {
    if (!prepared.images.mesh)
        return;
    surface_ = std::make_unique<Surface>(prepared, samples);
    count_.mesh = true;
    count_.closed = surface_->closed();
}

template <typename T> ContactReferee<T>::~ContactReferee() = default;

template <typename T> void ContactReferee<T>::check(const PathRows<T>& rows) {
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
            const T* const proxy = &rows.proxy[3 * at];
            Path& state = paths_[path];
            const bool stands = step > 0 && std::equal(position, position + 3, state.last);
            std::copy_n(position, 3, state.last);
            Sample sample{rows.path_first + path,
                          step,
                          {position[0], position[1], position[2]},
                          {proxy[0], proxy[1], proxy[2]},
                          rows.facet[at]};
            sample.probe = surface_->to_frame(sample.probe_place);
            sample.proxy = surface_->to_frame(sample.proxy_place);
            // A probe that left its bound stays where it was, without a proxy.
            if ((closed_loop_ && stands && !sample.touching()) || !std::isfinite(norm(sample.probe)) ||
                !std::isfinite(norm(sample.proxy)))
                continue;
            sample.tolerance = surface_->tolerance(sample.proxy, sample.probe_place);
            Judge(*surface_, state, sample, count_).judge();
        }
    }
}

template class ContactReferee<float>;
template class ContactReferee<double>;

} // namespace forceshade
