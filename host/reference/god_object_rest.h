// L6: when a god-object that came to rest goes on, and when it stays.
#pragma once

#include "host/reference/god_object_held.h"
#include "host/reference/god_object_walk.h"
#include "host/reference/god_object_ways.h"

namespace forceshade::reference {

/// The skin rounds edges and corners, and there a proxy may stop where the law would let it slide on. A proxy is at
/// rest where one or two faces right below hold it; elsewhere, if neither of these takes its contact closer to the
/// probe: the steepest ways from the corner or place it is at, over the faces and along the edges around, with strides
/// of several lengths, straight or, of the shortest, by walks over the corner; and a walk begun anew. What is tried
/// depends on the rest and the probe alone, so the same probe given again finds the same. Between spikes a way over the
/// corner may not be found: then it rests where it could go on (shaders/README.md tells how often).
template <typename T, typename Walk> class Settler {
public:
    Settler(const layout::MeshView<T>& mesh, Neighbourhood<T>& around, const Vector<T>& probe, Walk& walk) noexcept
        : mesh_(mesh), around_(around), probe_(probe), walk_(walk) {}

    /// From the rest of the last update to the next.
    GodObjectContact<T> run(Rest<T>& rest) noexcept {
        if (!rest.cornered) {
            walk_.put_back(rest);
            walk_.run();
            keep(rest);
            halted_ = walk_.at_corner();
        }
        if (!rest.cornered)
            return contact_at_faces(mesh_, around_, walk_, probe_);
        contact_ = contact_at_corner(mesh_, around_, rest, probe_);
        while (finished() && goes_on(rest) && rest.cornered)
            ++rounds_;
        return contact_;
    }

    bool finished() const noexcept { return walk_.finished() && rounds_ < kRounds; }

private:
    enum class Route { straight, lifted, over };
    static constexpr int kRounds = 1000;
    static constexpr int kWays = 4; /* the steepest */
    // Up to where a fold is wider than the skin.
    static constexpr int kStrides = Skin<T>::kDouble ? 6 : 3;
    static constexpr T kLengthen = T(8);
    static constexpr T kShort = Skin<T>::kWidth * T(2); /* what is not further off is the same place */
    static constexpr T kRounding = std::numeric_limits<T>::epsilon() * T(16);

    void keep(Rest<T>& rest) const noexcept {
        const Projection<T>& resting = walk_.resting();
        rest.proxy = walk_.proxy();
        rest.count = resting.count;
        // Only one or two faces right below the proxy leave no other way.
        rest.cornered = !walk_.rests() || resting.count == 3;
        for (layout::uint i = 0; i < resting.count; ++i) {
            rest.triangles[i] = walk_.touch(resting.held[i].source).index;
            rest.cornered = rest.cornered || !walk_.above_held_face(i);
        }
        rest.cornered = rest.cornered && resting.count > 0;
    }

    /// Where a rest is, without its skin where that is known.
    static const Vector<T>& place_of(const Rest<T>& rest, const GodObjectContact<T>& contact) noexcept {
        return contact.touching ? contact.proxy : rest.proxy;
    }

    /// Ways that gain less end where they begin but for rounding.
    T least_of_ways(const Vector<T>& pull) const noexcept {
        const T far = largest_of(pull) > kFarWay<T> ? T(0.0625) : T(1);
        return std::max(kShort, far * kRounding * std::sqrt(dot(pull, pull)));
    }

    /// Whether one place is elsewhere than another and closer to the probe for certain. Of a probe far off, of whose
    /// distance rounding leaves little, what counts is the way.
    bool comes_closer(const Vector<T>& from, const Vector<T>& to) const noexcept {
        const Vector<T> way = to - from, both = (probe_ - from) + (probe_ - to);
        if (!(dot(way, way) > kShort * kShort))
            return false;
        const T rounding = kRounding * std::sqrt(dot(way, way) * dot(both, both));
        return dot(way, both) > std::min(rounding, T(8) * kFarWay<T> * Skin<T>::kWidth);
    }

    bool goes_on(Rest<T>& rest) noexcept {
        const Rest<T> before = rest;
        const Vector<T> place = place_of(before, contact_);
        // Folds narrower than the skin may keep the proxy, but not its contact, off a corner.
        const T reach = place == before.proxy ? kFold<T> : Skin<T>::kCorner;
        const Crossing<T> corner = corner_at(mesh_, around_, place, reach, is_in_front(mesh_, before));
        if (corner.corner && goes_on_from(corner, before, rest))
            return true;
        const Crossing<T> beside{place, Skin<T>::kCorner * T(0.5), normalised(Vector<T>(before.proxy - place)), false,
                                 0};
        const Vector<T> off = corner.place - place;
        if (!corner.corner || dot(off, off) > Skin<T>::kCorner * Skin<T>::kCorner)
            if (goes_on_from(beside, before, rest))
                return true;
        walk_.put_back(before);
        walk_.run();
        // A walk that was only halted comes closer by itself, be it by less than rounding tells.
        return accepts(before, rest, halted_);
    }

    bool goes_on_from(const Crossing<T>& from, const Rest<T>& before, Rest<T>& rest) noexcept {
        const Vector<T> pull = probe_ - from.place;
        const T least = least_of_ways(pull);
        Way<T> way;
        for (int i = 0; i < kWays && next_way(mesh_, around_, from, probe_, least, way); ++i) {
            const Vector<T> normal = vector_at(mesh_.triangle_normals, way.triangle);
            const Vector<T> side = is_in_front(mesh_, before) ? normal : -normal;
            T length = kStride<T>;
            for (int j = 0; j < kStrides && (j == 0 || length < way.gain); ++j, length *= kLengthen) {
                const T stride = length < way.gain ? length : way.gain;
                const Vector<T> there = place_along(mesh_, from, way, stride, side);
                for (const Route route : {Route::straight, Route::lifted, Route::over}) {
                    if (route == Route::over && j > 0)
                        break; // three walks take long at corners of many triangles
                    walk_.put_back(before);
                    if (!takes(route, from, way.direction + side, stride, there))
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
    bool takes(Route route, const Crossing<T>& from, const Vector<T>& above, T stride,
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
        const Vector<T> way = now.proxy - before.proxy;
        if (!surely && dot(way, way) <= kShort * kShort)
            return false;
        const GodObjectContact<T> contact = now.cornered ? contact_at_corner(mesh_, around_, now, probe_)
                                                         : contact_at_faces(mesh_, around_, walk_, probe_);
        const bool far = largest_of(Vector<T>(probe_ - before.proxy)) > kFarWay<T>;
        const Vector<T> from = far ? before.proxy : place_of(before, contact_);
        if (!surely && !comes_closer(from, far ? now.proxy : place_of(now, contact)))
            return false;
        rest = now;
        contact_ = contact;
        halted_ = walk_.at_corner();
        return true;
    }

    const layout::MeshView<T>& mesh_;
    Neighbourhood<T>& around_;
    const Vector<T> probe_;
    Walk& walk_;
    GodObjectContact<T> contact_;
    bool halted_ = false; /* the walk, where a line between two faces ended */
    int rounds_ = 0;
};

} // namespace forceshade::reference
