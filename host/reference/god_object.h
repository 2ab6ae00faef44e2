// L6: the god-object (Zilles & Salisbury 1995) on a polygon mesh, converged fully in every update: when one that came
// to rest continues and when it stays, how its path begins, and the force that it gives.
#pragma once

#include "host/reference/chunks.h"
#include "host/reference/god_object_rest.h"
#include "host/reference/god_object_walk.h"
#include "host/reference/mesh_contact.h"
#include "host/reference/mesh_nearest.h"

namespace forceshade::reference {

/// The skin rounds edges and corners, and there a proxy may stop where the law would let it slide on. A proxy is at
/// rest where one or two faces right below constrain it; elsewhere, if neither of these takes its contact closer to the
/// probe: the steepest descents from the corner or place it is at, over the faces and along the edges there, with
/// strides of several lengths, straight or, of the shortest, by walks over the corner; and a walk begun anew. What is
/// tried depends on the rest and the probe alone, so the same probe given again finds the same. Between spikes a
/// descent over the corner may not be found: then it rests where it could go on (how often: shaders/README.md).
template <typename T, typename Walk> class RestSolver {
public:
    RestSolver(const layout::MeshView<T>& mesh, Neighbourhood<T>& neighbourhood, const Vector<T>& probe,
               Walk& walk) noexcept
        : mesh_(mesh), neighbourhood_(neighbourhood), probe_(probe), walk_(walk) {}

    /// From the rest of the last update to the next.
    GodObjectContact<T> run(Rest<T>& rest) noexcept {
        if (!rest.cornered) {
            walk_.restore(rest);
            walk_.run();
            keep(rest);
            halted_ = walk_.at_corner();
        }
        if (!rest.cornered)
            return contact_at_faces(mesh_, neighbourhood_, walk_, probe_);
        contact_ = contact_at_corner(mesh_, neighbourhood_, rest, probe_);
        while (finished() && continues(rest) && rest.cornered)
            ++rounds_;
        return contact_;
    }

    bool finished() const noexcept { return walk_.finished() && rounds_ < kRounds; }

private:
    enum class Route { straight, lifted, over };
    static constexpr int kRounds = 1000;
    static constexpr int kDescents = 4; /* the steepest */
    // Up to where a fold is wider than the skin.
    static constexpr int kStrides = Skin<T>::kDouble ? 6 : 3;
    static constexpr T kLengthen = T(8);
    static constexpr T kShort = Skin<T>::kWidth * T(2); /* what is not further off is the same place */
    static constexpr T kRounding = std::numeric_limits<T>::epsilon() * T(16);

    void keep(Rest<T>& rest) const noexcept {
        const Projection<T>& resting = walk_.resting();
        rest.proxy = walk_.proxy();
        rest.count = resting.count;
        // Only one or two faces right below the proxy leave no other displacement.
        rest.cornered = !walk_.rests() || resting.count == 3;
        for (layout::uint i = 0; i < resting.count; ++i) {
            rest.triangles[i] = walk_.touch(resting.active[i].source).index;
            rest.cornered = rest.cornered || !walk_.above_constraining_face(i);
        }
        if (resting.count == 0 && rest.cornered)
            rest_on_nearest(rest);
    }

    /// Of a walk that was stopped by what then constrained it no longer.
    void rest_on_nearest(Rest<T>& rest) const noexcept {
        rest.count = nearest_near(mesh_, neighbourhood_, rest.proxy, rest.triangles[0]) ? 1 : 0;
        rest.cornered = rest.count > 0;
    }

    /// Where a rest is, without its skin if planes define the contact.
    static const Vector<T>& place_of(const Rest<T>& rest, const GodObjectContact<T>& contact) noexcept {
        return contact.touching && !contact.by_distance ? contact.proxy : rest.proxy;
    }

    /// Descents that gain less end where they begin but for rounding.
    T least_gain(const Vector<T>& pull) const noexcept {
        const T far = largest_coordinate(pull) > kLongestMove<T> ? T(0.0625) : T(1);
        return std::max(kShort, far * kRounding * std::sqrt(dot(pull, pull)));
    }

    /// Whether one place is elsewhere than another and closer to the probe for certain. Of a probe far off, of whose
    /// distance rounding leaves little, what counts is the displacement.
    bool is_closer(const Vector<T>& from, const Vector<T>& to) const noexcept {
        const Vector<T> displacement = to - from, both = (probe_ - from) + (probe_ - to);
        if (!(dot(displacement, displacement) > kShort * kShort))
            return false;
        const T rounding = kRounding * std::sqrt(dot(displacement, displacement) * dot(both, both));
        return dot(displacement, both) > std::min(rounding, T(8) * kLongestMove<T> * Skin<T>::kWidth);
    }

    bool continues(Rest<T>& rest) noexcept {
        const Rest<T> before = rest;
        const Vector<T> place = place_of(before, contact_);
        // Folds narrower than the skin may keep the proxy, but not its contact, off a corner.
        const T reach = place == before.proxy ? kFold<T> : Skin<T>::kCorner;
        const StartPoint<T> corner = nearest_corner(mesh_, neighbourhood_, place, reach, is_in_front(mesh_, before));
        if (corner.corner && continues_from(corner, before, rest))
            return true;
        const StartPoint<T> here{place, Skin<T>::kCorner * T(0.5), normalised(Vector<T>(before.proxy - place)), false,
                                 0};
        const Vector<T> off = corner.place - place;
        if (!corner.corner || dot(off, off) > Skin<T>::kCorner * Skin<T>::kCorner)
            if (continues_from(here, before, rest))
                return true;
        walk_.restore(before);
        walk_.run();
        // A walk that was only halted comes closer by itself, be it by less than rounding.
        return accepts(before, rest, halted_);
    }

    bool continues_from(const StartPoint<T>& from, const Rest<T>& before, Rest<T>& rest) noexcept {
        const Vector<T> pull = probe_ - from.place;
        const T least = least_gain(pull);
        Descent<T> descent;
        for (int i = 0; i < kDescents && next_descent(mesh_, neighbourhood_, from, probe_, least, descent); ++i) {
            const Vector<T> normal = vector_at(mesh_.triangle_normals, descent.triangle);
            const Vector<T> side = is_in_front(mesh_, before) ? normal : -normal;
            T length = kStride<T>;
            for (int j = 0; j < kStrides && (j == 0 || length < descent.gain); ++j, length *= kLengthen) {
                const T stride = length < descent.gain ? length : descent.gain;
                const Vector<T> there = place_along(mesh_, from, descent, stride, side);
                for (const Route route : {Route::straight, Route::lifted, Route::over}) {
                    if (route == Route::over && j > 0)
                        break; // three walks take long at corners of many triangles
                    walk_.restore(before);
                    if (!reaches(route, from, descent.direction + side, stride, there))
                        continue;
                    walk_.run();
                    if (accepts(before, rest))
                        return true;
                }
            }
        }
        return false;
    }

    /// Whether the proxy gets to a place a stride from a corner: straight; from a place out of the corner; or by walks
    /// out and then above that place (`above` leads there from the corner), round spikes and ridges between it and the
    /// sector of the corner where the proxy is.
    bool reaches(Route route, const StartPoint<T>& from, const Vector<T>& above, T stride,
                 const Vector<T>& there) noexcept {
        const Vector<T> out = from.place + stride * from.out;
        if (route == Route::over) {
            walk_.walk_to(out);
            walk_.walk_to(from.place + stride * normalised(above));
            return walk_.walk_to(there);
        }
        const bool has_out = dot(from.out, from.out) > T(0);
        return (route == Route::straight || (has_out && walk_.jump(out))) && walk_.jump(there);
    }

    /// Whether the walk ended where the contact is closer to the probe.
    bool accepts(const Rest<T>& before, Rest<T>& rest, bool surely = false) noexcept {
        Rest<T> now;
        keep(now);
        const Vector<T> displacement = now.proxy - before.proxy;
        if (!surely && dot(displacement, displacement) <= kShort * kShort)
            return false;
        const GodObjectContact<T> contact = now.cornered ? contact_at_corner(mesh_, neighbourhood_, now, probe_)
                                                         : contact_at_faces(mesh_, neighbourhood_, walk_, probe_);
        const bool far = largest_coordinate(Vector<T>(probe_ - before.proxy)) > kLongestMove<T>;
        const Vector<T> from = far ? before.proxy : place_of(before, contact_);
        if (!surely && !is_closer(from, far ? now.proxy : place_of(now, contact)))
            return false;
        rest = now;
        contact_ = contact;
        halted_ = walk_.at_corner();
        return true;
    }

    const layout::MeshView<T>& mesh_;
    Neighbourhood<T>& neighbourhood_;
    const Vector<T> probe_;
    Walk& walk_;
    GodObjectContact<T> contact_;
    bool halted_ = false; /* the walk, where a line between two faces ended */
    int rounds_ = 0;
};

/// The state of one path, in the mesh's frame. As constructed: a path that has not begun.
template <typename T> struct GodObject : Rest<T> { bool started = false; };

/// Takes a place less than a skin from a triangle a skin away from it: straight, or, if that crosses another one, as in
/// an acute corner, away from all that are as near; straight nevertheless where there is no room between them.
template <typename T>
Vector<T> displacement_off(const layout::MeshView<T>& mesh, Neighbourhood<T>& neighbourhood, const Vector<T>& place,
                           const Touch<T>& nearest) noexcept {
    const auto off = [](const Touch<T>& touch) {
        return HalfSpace<T>{touch.distance > Skin<T>::kRest ? touch.away : touch.face, Skin<T>::kWidth - touch.distance,
                            touch.index};
    };
    const HalfSpace<T> one = off(nearest);
    const Vector<T> straight = one.slack * one.normal;
    const auto blocked = [&](const Vector<T>& displacement) {
        return is_blocked(mesh, neighbourhood, place, Vector<T>(place + displacement), T(0));
    };
    if (!blocked(straight))
        return straight;
    Projection<T> all;
    const bool found = project(
        Vector<T>(T(0)), one_tolerance(Skin<T>::kFlush), all, [&](const Vector<T>& displacement, HalfSpace<T>& space) {
            T most = Skin<T>::kFlush;
            visit_near(mesh, neighbourhood, Move<T>{place, Vector<T>(T(0)), T(0)}, [&](layout::uint index) {
                Touch<T> touch{};
                begin_touch(mesh, index, touch);
                update_touch(touch, place);
                const HalfSpace<T> other = off(touch);
                const T violation = other.slack - dot(other.normal, displacement);
                if (!(touch.distance < Skin<T>::kWidth) || !(violation > most))
                    return;
                most = violation;
                space = other;
            });
            return most > Skin<T>::kFlush;
        });
    const bool room = found && !blocked(all.vector);
    return room ? all.vector : straight;
}

/// Begins a path: the proxy is the probe, or a skin away from what it touches, on the side where it is; in front of a
/// triangle if it is on it exactly.
template <typename T>
void begin_path(const layout::MeshView<T>& mesh, GodObject<T>& state, Neighbourhood<T>& neighbourhood,
                const Vector<T>& probe) noexcept {
    constexpr int kTries = 64;
    state.proxy = probe;
    state.count = 0;
    state.cornered = false;
    state.started = true;
    if (largest_coordinate(probe) > T(kRegion))
        return;
    for (int i = 0; i < kTries; ++i) {
        Touch<T> nearest{}, touch{};
        nearest.distance = Skin<T>::kImpact;
        visit_near(mesh, neighbourhood, Move<T>{state.proxy, Vector<T>(T(0)), T(0)}, [&](layout::uint index) {
            begin_touch(mesh, index, touch);
            update_touch(touch, state.proxy);
            const bool first = touch.distance == nearest.distance && comes_before(mesh, index, nearest.index);
            if (touch.distance < nearest.distance || first)
                nearest = touch;
        });
        if (!(nearest.distance < Skin<T>::kImpact))
            return;
        state.proxy += displacement_off(mesh, neighbourhood, state.proxy, nearest);
    }
}

/// In corners with no room for two skins a walk may push the proxy out, away from the probe: then it stays where the
/// update began.
template <typename T>
void hold_if_grown(const layout::MeshView<T>& mesh, Neighbourhood<T>& neighbourhood, const Vector<T>& begin,
                   const Vector<T>& probe, Rest<T>& rest, GodObjectContact<T>& contact) noexcept {
    if (!Certificate<T>(mesh, neighbourhood, begin, probe).has_grown(contact.proxy) ||
        !nearest_near(mesh, neighbourhood, begin, rest.triangles[0]))
        return;
    rest.proxy = begin;
    rest.count = 1;
    rest.cornered = true;
    const Triangle<T> triangle = triangle_at(mesh, rest.triangles[0]);
    const bool front = !(dot(triangle.normal, begin - triangle.corners[0]) < T(0));
    ConstrainingFaces<T> face;
    face.count = 1;
    face.triangles[0] = rest.triangles[0];
    face.normals[0] = front ? triangle.normal : -triangle.normal;
    contact = contact_by_distance(mesh, neighbourhood, begin, face, probe);
    contact.finished = false;
}

/// At an edge sharper than the skin a walk may get no further, though no triangle is between the proxy and a probe in
/// the open: then the proxy goes straight there.
template <typename T, typename Trace>
void reach_open_probe(const layout::MeshView<T>& mesh, Neighbourhood<T>& neighbourhood, const Vector<T>& probe,
                      const Trace& trace, Rest<T>& rest) noexcept {
    const Vector<T> left = probe - rest.proxy;
    layout::uint triangle = 0;
    if (dot(left, left) <= Skin<T>::kNear * Skin<T>::kNear ||
        (nearest_near(mesh, neighbourhood, probe, triangle) &&
         nearest_on_triangle(probe, triangle_at(mesh, triangle)).square <= Skin<T>::kWidth * Skin<T>::kWidth))
        return;
    trace(rest.proxy, probe);
    rest.proxy = probe;
    rest.count = 0;
    rest.cornered = false;
}

/// The update of a path that has begun, to a probe that is finite.
template <typename T, typename Trace>
GodObjectContact<T> follow(const layout::MeshView<T>& mesh, GodObject<T>& state, Neighbourhood<T>& neighbourhood,
                           const Vector<T>& probe, const Trace& trace) noexcept {
    Rest<T> rest = state;
    Walk<T, Trace> walk(mesh, neighbourhood, state.proxy, probe, trace);
    RestSolver<T, Walk<T, Trace>> solver(mesh, neighbourhood, probe, walk);
    GodObjectContact<T> contact = solver.run(rest);
    contact.finished = contact.finished && solver.finished();
    if (contact.by_distance)
        hold_if_grown(mesh, neighbourhood, state.proxy, probe, rest, contact);
    else if (rest.cornered && !contact.touching)
        reach_open_probe(mesh, neighbourhood, probe, trace, rest);
    contact.substeps = walk.substeps();
    state.proxy = rest.proxy;
    state.cornered = rest.cornered;
    state.count = rest.cornered ? rest.count : contact.count;
    for (layout::uint i = 0; i < 3; ++i)
        if (i < state.count)
            state.triangles[i] = rest.cornered ? rest.triangles[i] : contact.triangles[i];
    return contact;
}

/// L6: the probe takes its new position, in the mesh's frame; the proxy follows until it can come no closer,
/// crossing no triangle. A probe that is not finite changes no state and is out of contact. No allocation.
template <typename T, typename Trace = NoTrace>
GodObjectContact<T> update(const layout::MeshView<T>& mesh, GodObject<T>& state, Neighbourhood<T>& neighbourhood,
                           const Vector<T>& probe, const Trace& trace = {}) noexcept {
    if (!is_finite(probe))
        return out_of_contact(probe);
    if (!state.started)
        begin_path(mesh, state, neighbourhood, probe);
    return follow(mesh, state, neighbourhood, probe, trace);
}

template <typename T> bool is_behind(const layout::Law<T>& law, const Vector<T>& place) noexcept {
    return is_inside(law, nearest(law.mesh, place), place);
}

/// Of a place on a corner or an edge, where in front of one triangle may be behind another: begins above the triangles
/// there, off the corner, at the first of these places that is in front, if one is.
template <typename T>
void begin_aside(const layout::Law<T>& law, GodObject<T>& state, Neighbourhood<T>& neighbourhood,
                 const Vector<T>& place) noexcept {
    constexpr layout::uint kMost = 64;
    layout::uint triangles[kMost], count = 0;
    Touch<T> touch{};
    visit_near(law.mesh, neighbourhood, Move<T>{place, Vector<T>(T(0)), T(0)}, [&](layout::uint index) {
        begin_touch(law.mesh, index, touch);
        update_touch(touch, place);
        if (touch.distance < Skin<T>::kImpact && count < kMost)
            triangles[count++] = index;
    });
    for (layout::uint i = 0; i < count; ++i) {
        const Triangle<T> triangle = triangle_at(law.mesh, triangles[i]);
        const Vector<T> middle = (triangle.corners[0] + triangle.corners[1] + triangle.corners[2]) / T(3);
        const Vector<T> off = middle - place;
        const T share = std::min(T(1), kStride<T> / length(off));
        GodObject<T> aside;
        begin_path(law.mesh, aside, neighbourhood, place + share * off + Skin<T>::kWidth * triangle.normal);
        if (!is_behind(law, aside.proxy)) {
            state = aside;
            return;
        }
    }
}

/// Where the proxy is before the first step: at the probe, or a skin away from what it touches, in front. A path that
/// begins behind the surface begins at the nearest place of it, in front. `probe` is in the mesh's frame.
template <typename T>
layout::ProxyStart<T> proxy_start(const layout::Law<T>& law, Neighbourhood<T>& neighbourhood,
                                  const Vector<T>& probe) noexcept {
    Vector<T> place = probe;
    bool inside = false;
    if (largest_coordinate(probe) <= T(kRegion)) {
        const Nearest<T> found = nearest(law.mesh, probe);
        inside = is_inside(law, found, probe);
        if (inside) {
            const Vector<T> displacement = normalised(found.offset);
            const bool deep = dot(displacement, displacement) > T(0);
            const Vector<T> out = deep ? displacement : vector_at(law.mesh.triangle_normals, found.triangle);
            place = (probe + found.offset) + Skin<T>::kWidth * out;
        }
    }
    GodObject<T> state;
    begin_path(law.mesh, state, neighbourhood, place);
    if (state.proxy != place && is_behind(law, state.proxy))
        begin_aside(law, state, neighbourhood, place);
    return {state.proxy.x, state.proxy.y, state.proxy.z, inside ? 1U : 0U};
}

/// A god-object before its first update.
template <typename T> GodObject<T> god_object_at(const layout::ProxyStart<T>& start) noexcept {
    GodObject<T> state;
    state.proxy = {start.x, start.y, start.z};
    state.started = true;
    return state;
}

/// L7 to L9 on the god-object's contact: the force on a probe in the mesh's frame. The facet shaded is the lowest of
/// those that constrain it; seen from behind, its interpolated normal is reversed.
template <typename T>
Contact<T> mesh_contact(const layout::Law<T>& law, const GodObjectContact<T>& rest, const Vector<T>& probe) noexcept {
    if (!rest.touching)
        return free_contact(law, probe);
    const Vector<T> offset = rest.proxy - probe;
    MeshTouch<T> touch{rest.facets[0], offset, rest.proxy, std::sqrt(dot(offset, offset))};
    Contact<T> contact = touching_contact(law, touch);
    if (dot(rest.normals[0], vector_at(law.mesh.triangle_normals, rest.triangles[0])) < T(0)) {
        const T stiffness = law.mesh.params.stiffness;
        const Vector<T> pull{stiffness * offset.x, stiffness * offset.y, stiffness * offset.z};
        touch.offset = -offset;
        contact.force = (contact.unshaded - pull) - shaded_force(law, touch, Vector<T>(-pull));
    }
    return contact;
}

/// Keeps a hash of the places that the proxy walks through, of how it stands to the triangles near it there, and then
/// of the triangles that hold it: a walk that goes another way to the same contact has another.
struct Trail {
    layout::uint& hash;
    template <typename T> void operator()(const Vector<T>&, const Vector<T>& place) const noexcept {
        hash = hashed(hash, place);
    }
    template <typename T> void sees(const TouchPool<T>& pool) const noexcept {
        for (layout::uint i = 0; i < pool.count(); ++i)
            hash = hashed(hash, digest_of(pool[i]));
        hash = hashed(hash, folded(pool.tolerance()));
    }
};

template <typename T> struct TrailedContact {
    GodObjectContact<T> contact;
    layout::uint trail;
};

/// update() with the trail of its walk.
template <typename T>
TrailedContact<T> update_with_trail(const layout::MeshView<T>& mesh, GodObject<T>& state,
                                    Neighbourhood<T>& neighbourhood, const Vector<T>& probe) noexcept {
    layout::uint trail = 0;
    const GodObjectContact<T> contact = update(mesh, state, neighbourhood, probe, Trail{trail});
    for (layout::uint i = 0; i < contact.count; ++i)
        trail = hashed(trail, contact.triangles[i]);
    return {contact, trail};
}

/// What a probe feels of a god-object that was updated: `probe`, m, from the scene's origin, `local` in the mesh's
/// frame. Out of contact the proxy is the probe.
template <typename T>
LawContact<T> law_contact(const layout::Law<T>& law, const GodObjectContact<T>& rest, const Vector<T>& probe,
                          const Vector<T>& local, layout::uint trail = 0) noexcept {
    LawContact<T> found{mesh_contact(law, rest, local), rest.finished, trail};
    if (found.contact.facet == layout::kNoFacet)
        found.contact.proxy = probe; // not there and back through the mesh's frame
    return found;
}

/// A probe that moves: its god-object comes after it.
template <typename T>
LawContact<T> follow(const layout::Law<T>& law, GodObject<T>& proxy, Neighbourhood<T>& around, const Vector<T>& probe,
                     const Vector<T>& local) noexcept {
    return law_contact(law, update(law.mesh, proxy, around, local), probe, local);
}

/// The radius of a ball around a place that no triangle enters: up to half the mesh's frame, and less what rounding and
/// the skin make of it.
template <typename T> T free_reach(const layout::MeshView<T>& mesh, const Vector<T>& place) noexcept {
    constexpr T kMargin = T(2) * (Skin<T>::kCorner + T(0x1p-20));
    const T reach = std::sqrt(nearest(mesh, place).square) - kMargin;
    return reach > T(0) ? std::min(reach, T(0.5)) : T(0);
}

/// An update that the kernel leaves to the host.
template <typename T>
void finish_update(const layout::MeshView<T>& mesh, Neighbourhood<T>& neighbourhood,
                   layout::MeshUpdate<T>& one) noexcept {
    GodObject<T> state;
    state.proxy = {one.proxy[0], one.proxy[1], one.proxy[2]};
    std::copy(one.triangles, one.triangles + 3, state.triangles);
    state.count = one.count;
    state.cornered = one.cornered;
    state.started = true;
    const auto [contact, trail] =
        update_with_trail(mesh, state, neighbourhood, Vector<T>(one.probe[0], one.probe[1], one.probe[2]));
    for (int i = 0; i < 3; ++i) {
        one.proxy[i] = state.proxy[i];
        one.rest[i] = contact.proxy[i];
    }
    std::copy(state.triangles, state.triangles + 3, one.triangles);
    one.count = state.count;
    one.cornered = state.cornered;
    one.touching = contact.touching;
    one.finished = contact.finished;
    one.trail = trail;
    one.triangle = contact.touching ? contact.triangles[0] : 0;
    one.reach =
        contact.touching || !(largest_coordinate(state.proxy) <= T(kRegion)) ? T(0) : free_reach(mesh, state.proxy);
    one.back =
        contact.touching && dot(contact.normals[0], vector_at(mesh.triangle_normals, contact.triangles[0])) < T(0);
}

/// On `threads` threads; no update depends on another.
template <typename T>
void finish_updates(const layout::MeshView<T>& mesh, std::span<layout::MeshUpdate<T>> updates, unsigned threads) {
    constexpr std::size_t kShare = 16; // that a thread takes at once
    const std::size_t used = std::clamp<std::size_t>(updates.size() / kShare, 1, std::max(threads, 1u));
    std::vector<Neighbourhood<T>> neighbourhoods(used);
    share_out(used, (updates.size() + kShare - 1) / kShare, [&](std::size_t thread, std::size_t share) {
        for (layout::MeshUpdate<T>& one :
             updates.subspan(share * kShare).first(std::min(kShare, updates.size() - share * kShare)))
            finish_update(mesh, neighbourhoods[thread], one);
    });
}

#define FORCESHADE_GOD_OBJECT(SPECIFIER, T)                                                                            \
    SPECIFIER template GodObjectContact<T> update(const layout::MeshView<T>&, GodObject<T>&, Neighbourhood<T>&,        \
                                                  const Vector<T>&, const NoTrace&) noexcept;                          \
    SPECIFIER template GodObjectContact<T> update(const layout::MeshView<T>&, GodObject<T>&, Neighbourhood<T>&,        \
                                                  const Vector<T>&, const Trail&) noexcept;                            \
    SPECIFIER template layout::ProxyStart<T> proxy_start(const layout::Law<T>&, Neighbourhood<T>&,                     \
                                                         const Vector<T>&) noexcept;                                   \
    SPECIFIER template void finish_updates(const layout::MeshView<T>&, std::span<layout::MeshUpdate<T>>, unsigned);
#ifndef FORCESHADE_HEADER_ONLY // compiled once, in paths.cpp
FORCESHADE_GOD_OBJECT(extern, float)
FORCESHADE_GOD_OBJECT(extern, double)
#endif

} // namespace forceshade::reference
