// L6: the triangles that a god-object may touch, and the way that they leave it.
#pragma once

#include "host/reference/god_object_touch.h"

namespace forceshade::reference {

/// No way is longer, so that no rounding of one is as large as the skin; every way within the region is shorter.
template <typename T> constexpr T kFarWay = T(8);

/// The few triangles near the proxy that are minded by their half-spaces rather than by casts.
template <typename T> class TouchPool {
public:
    static constexpr layout::uint kMost = 8;

    explicit TouchPool(const layout::MeshView<T>& mesh) noexcept : mesh_(mesh) {}

    layout::uint count() const noexcept { return count_; }
    Touch<T>& operator[](layout::uint i) noexcept { return touches_[i]; }
    const Touch<T>& operator[](layout::uint i) const noexcept { return touches_[i]; }
    /// The way found last, and what holds it to that.
    const Projection<T>& projection() const noexcept { return projection_; }
    Hold hold(layout::uint i) const noexcept { return holds_[i]; }
    /// Shorter moves are none.
    T tolerance() const noexcept { return tolerance_; }
    /// The way found last ends before the point it is for.
    bool shortened() const noexcept { return shortened_; }

    void forget_all() noexcept { count_ = projection_.count = 0; }

    /// After moves: planes may be tried again.
    void allow_faces() noexcept {
        for (layout::uint i = 0; i < count_; ++i)
            touches_[i].faceless = false;
    }

    /// What the proxy may touch; no harm if it does not.
    void remember(layout::uint triangle, const Vector<T>& proxy) noexcept {
        if (knows(triangle) || (count_ == kMost && !forget_one()))
            return;
        begin_touch(mesh_, triangle, touches_[count_]);
        look(touches_[count_], proxy);
        holds_[count_++] = Hold::none;
    }

    bool knows(layout::uint triangle) const noexcept {
        for (layout::uint i = 0; i < count_; ++i)
            if (touches_[i].index == triangle)
                return true;
        return false;
    }

    void look_again(const Vector<T>& proxy) noexcept {
        layout::uint kept = 0;
        for (layout::uint i = 0; i < count_; ++i) {
            if (kept != i)
                touches_[kept] = touches_[i];
            look(touches_[kept], proxy);
            kept += touches_[kept].distance <= Skin<T>::kNear ? 1 : 0;
        }
        count_ = kept;
    }

    /// The way to the point nearest to the probe that the touched triangles allow.
    void find_way(const Vector<T>& proxy, const Vector<T>& probe) noexcept {
        const Vector<T> wish = probe - proxy;
        const T length = largest_of(wish);
        shortened_ = false;
        if (length > kFarWay<T>) {
            find_far_way(proxy, probe);
            return;
        }
        tolerance_ = Skin<T>::kRest + T(8) * std::numeric_limits<T>::epsilon() * length;
        if (count_ == 1 && touches_[0].above_face()) {
            find_way_on_face(wish);
            return;
        }
        for (const bool relaxed : {false, true})
            if (project(wish, one_tolerance(tolerance_), projection_, [&](const Vector<T>& way, HalfSpace<T>& space) {
                    return worst(way, relaxed, tolerance_, space);
                }))
                return;
        projection_.vector = Vector<T>(T(0));
    }

    /// Whether a move keeps to the half-space of a triangle in the pool, so that it cannot cross it. Rounding tilts the
    /// plane of a rounded edge or corner: unless it holds the move, which then ends a skin aside, a long move may keep
    /// to that plane and cross the triangle, so a cast decides.
    bool keeps_off(layout::uint triangle, const Vector<T>& way) const noexcept {
        for (layout::uint i = 0; i < count_; ++i) {
            if (touches_[i].index != triangle)
                continue;
            for (layout::uint j = 0; j < projection_.count; ++j)
                if (projection_.held[j].source == i)
                    return true;
            const Hold hold = hold_of(touches_[i], way);
            if (hold == Hold::none || (hold == Hold::rounded && !(largest_of(way) <= Skin<T>::kWidth)))
                return false;
            const HalfSpace<T> space = half_space(touches_[i], hold, i);
            return dot(space.normal, way) >= space.slack - tolerance_;
        }
        return false;
    }

    /// Whether a triangle is behind a plane that the move keeps a skin in front of.
    bool lies_below(const Triangle<T>& triangle) const noexcept {
        constexpr T kFlush = Skin<T>::kRest * T(0.25);
        for (layout::uint j = 0; j < projection_.count; ++j) {
            const layout::uint source = projection_.held[j].source;
            if (holds_[source] != Hold::face)
                continue;
            const Vector<T>& normal = touches_[source].face;
            const Vector<T>& corner = touches_[source].triangle.corners[0];
            if (dot(normal, triangle.corners[0] - corner) <= kFlush &&
                dot(normal, triangle.corners[1] - corner) <= kFlush &&
                dot(normal, triangle.corners[2] - corner) <= kFlush)
                return true;
        }
        return false;
    }

private:
    bool forget_one() noexcept {
        for (layout::uint i = 0; i < count_; ++i) {
            bool held = false;
            for (layout::uint j = 0; j < projection_.count; ++j)
                held = held || projection_.held[j].source == i;
            if (held)
                continue;
            for (layout::uint j = 0; j < projection_.count; ++j)
                projection_.held[j].source -= projection_.held[j].source > i ? 1 : 0;
            for (layout::uint j = i; j + 1 < count_; ++j) {
                touches_[j] = touches_[j + 1];
                holds_[j] = holds_[j + 1];
            }
            --count_;
            return true;
        }
        return false;
    }

    /// The worst violated half-space: those of faces below the proxy first, since the others depend on where it goes.
    bool worst(const Vector<T>& way, bool relaxed, T tolerance, HalfSpace<T>& result) noexcept {
        T most = tolerance;
        bool found = false;
        for (const bool faces : {true, false}) {
            for (layout::uint i = 0; i < count_; ++i) {
                if (touches_[i].above_face() != faces)
                    continue;
                const Hold hold = hold_of(touches_[i], way);
                if (hold == Hold::none)
                    continue;
                HalfSpace<T> space = half_space(touches_[i], hold, i);
                if (relaxed && space.slack > T(0))
                    space.slack = T(0);
                const T violation = space.slack - dot(space.normal, way);
                if (violation > most) {
                    most = violation;
                    result = space;
                    holds_[i] = hold;
                    found = true;
                }
            }
            if (found)
                return true;
        }
        return false;
    }

    /// The same for a probe far off, of whose way into the planes little may be left along them. Finds the point
    /// itself, so that what rounding makes of it stays the same wherever the proxy is.
    void find_far_way(const Vector<T>& proxy, const Vector<T>& probe) noexcept {
        constexpr T kRounding = T(8) * std::numeric_limits<T>::epsilon();
        const T push = Skin<T>::kRest + kRounding * largest_of(probe);
        const Tolerance<T> tolerance{push, Skin<T>::kRest + kRounding, push};
        bool found = false;
        for (const bool relaxed : {false, true}) {
            if (found)
                break;
            found = project(probe, tolerance, projection_, [&](const Vector<T>& point, HalfSpace<T>& space) {
                if (!worst(Vector<T>(point - proxy), relaxed, tolerance.height(point), space))
                    return false;
                space.slack += dot(space.normal, proxy);
                return true;
            });
        }
        projection_.vector = found ? projection_.vector - proxy : Vector<T>(T(0));
        const T length = largest_of(projection_.vector);
        shortened_ = length > kFarWay<T>;
        if (shortened_)
            projection_.vector = projection_.vector * (kFarWay<T> / length);
        tolerance_ = Skin<T>::kRest + kRounding * (shortened_ ? kFarWay<T> : T(1) + length);
    }

    /// The same for one face alone, the most common case.
    void find_way_on_face(const Vector<T>& wish) noexcept {
        const Vector<T>& normal = touches_[0].face;
        const T slack = Skin<T>::kWidth - touches_[0].height;
        const T multiplier = slack - dot(normal, wish);
        holds_[0] = Hold::face;
        projection_.count = multiplier > tolerance_ ? 1 : 0;
        projection_.vector = wish;
        if (projection_.count == 0)
            return;
        const Vector<T> way = wish + multiplier * normal;
        projection_.vector = way + (slack - dot(normal, way)) * normal;
        projection_.multipliers[0] = multiplier;
        projection_.held[0].normal = normal;
        projection_.held[0].slack = slack;
        projection_.held[0].source = 0;
    }

    const layout::MeshView<T>& mesh_;
    Touch<T> touches_[kMost];
    Hold holds_[kMost];
    layout::uint count_ = 0;
    Projection<T> projection_;
    T tolerance_{};
    bool shortened_ = false;
};

} // namespace forceshade::reference
