// L6: what a god-object that came to rest on rounded edges does next, and what holds it.
#pragma once

#include "host/reference/god_object_walk.h"

namespace forceshade::reference {

/// The planes, by facet, of the triangles within reach of the skin, sides as the proxy sees them. Of too many, those
/// that lead furthest towards the probe.
template <typename T> struct Touching {
    static constexpr layout::uint kCapacity = 64;
    layout::uint triangles[kCapacity];
    layout::uint facets[kCapacity];
    Vector<T> normals[kCapacity]; /* of the faces */
    Vector<T> aways[kCapacity];   /* from what of them is nearest */
    T gains[kCapacity];           /* of the best stride on each */
    layout::uint count = 0;
    layout::uint near = 0;  /* all of them, in the list or not */
    layout::uint least = 0; /* of a full list, which gains least */
    Vector<T> corner;       /* the nearest corner of any */
    T corner_distance;
};

template <typename T> void copy_touching(Touching<T>& list, layout::uint from, layout::uint to) noexcept {
    list.triangles[to] = list.triangles[from];
    list.facets[to] = list.facets[from];
    list.normals[to] = list.normals[from];
    list.aways[to] = list.aways[from];
    list.gains[to] = list.gains[from];
}

/// Which of a full list gains least, the last by facet and triangle among equals.
template <typename T> layout::uint least_of(const Touching<T>& list) noexcept {
    layout::uint least = 0;
    for (layout::uint i = 1; i < list.count; ++i)
        least = list.gains[i] <= list.gains[least] ? i : least;
    return least;
}

template <typename T>
void insert_by_facet(Touching<T>& list, layout::uint facet, const Touch<T>& touch, T gain) noexcept {
    const auto later = [&](layout::uint i) {
        return list.facets[i] > facet || (list.facets[i] == facet && list.triangles[i] > touch.index);
    };
    layout::uint place = list.count;
    if (list.count == Touching<T>::kCapacity) {
        place = list.least;
        if (list.gains[place] > gain || (list.gains[place] == gain && !later(place)))
            return;
        for (; place + 1 < list.count && !later(place + 1); ++place)
            copy_touching(list, place + 1, place);
    } else {
        ++list.count;
    }
    for (; place > 0 && later(place - 1); --place)
        copy_touching(list, place - 1, place);
    list.triangles[place] = touch.index;
    list.facets[place] = facet;
    list.normals[place] = touch.face;
    list.aways[place] = touch.away;
    list.gains[place] = gain;
    if (list.count == Touching<T>::kCapacity)
        list.least = least_of(list);
}

template <typename T>
void find_touching(const layout::MeshView<T>& mesh, Neighbourhood<T>& around, const Vector<T>& proxy,
                   const Vector<T>& probe, T reach, Touching<T>& list) noexcept {
    list.count = list.near = 0;
    list.corner_distance = std::numeric_limits<T>::max();
    const Vector<T> pull = normalised(Vector<T>(probe - proxy));
    visit_near(mesh, around, Move<T>{proxy, Vector<T>(T(0)), T(0)}, [&](layout::uint index) {
        Touch<T> touch;
        begin_touch(mesh, index, touch);
        look(touch, proxy);
        if (!(touch.distance <= reach) || !(dot(touch.face, touch.face) > T(0)))
            return;
        ++list.near;
        const Vector<T> goal = kStride<T> * pull;
        const Vector<T> stride = goal + nearest_on_triangle(Vector<T>(proxy + goal), touch.triangle).offset;
        insert_by_facet(list, mesh.triangle_facets[index], touch, dot(stride, pull));
        for (const Vector<T>& corner : touch.triangle.corners) {
            const T distance = std::sqrt(dot(corner - proxy, corner - proxy));
            if (distance < list.corner_distance) {
                list.corner_distance = distance;
                list.corner = corner;
            }
        }
    });
}

/// The skin rounds edges and corners, and on one a proxy may stand where the law would let it slide on. Tries the ways
/// that lead from there over a face or along where two meet, the steepest first, the lowest facet first among equals,
/// and keeps the first that brings the proxy closer to the probe.
template <typename T, typename Walk> class Settler {
public:
    Settler(const layout::MeshView<T>& mesh, Neighbourhood<T>& around, const Vector<T>& probe, Walk& walk) noexcept
        : mesh_(mesh), around_(around), probe_(probe), walk_(walk) {}

    /// `cornered`: whether the proxy rested at a corner or an edge.
    void run(bool cornered) noexcept {
        constexpr int kRounds = 64;
        if (cornered)
            turn();
        follow();
        for (int i = 0; i < kRounds && doubtful() && depth() > kGain && walk_.finished(); ++i)
            if (!slide())
                return;
    }

    /// Only one or two faces right below the proxy leave no other way.
    bool doubtful() const noexcept {
        const layout::uint count = walk_.resting().count;
        bool result = count == 3;
        for (layout::uint i = 0; i < count; ++i)
            result = result || !walk_.above_held_face(i);
        return result;
    }

private:
    static constexpr T kGain = Skin<T>::kWidth * T(4);
    // Near a corner of a thousand triangles each look at them takes its time: a millisecond or so in all.
    static constexpr layout::uint kMostEffort = 8192;
    static constexpr layout::uint kTryEffort = 4;

    /// Where ways begin, and how far off a triangle a stride along it may end.
    struct Base {
        Vector<T> place;
        T tolerance;
    };

    struct Way {
        Vector<T> direction{T(0)}; /* unit */
        T gain = T(0);             /* towards the probe, a length of way */
        layout::uint one = 0, other = 0;
    };

    /// Walks to rest, at corners on by the steepest way.
    void follow() noexcept {
        walk_.run();
        while (walk_.at_corner() && walk_.finished()) {
            turn();
            walk_.run();
        }
    }

    /// At a corner. If the steepest way leads off the surface, the walk finds that by itself.
    void turn() noexcept {
        Touching<T> list;
        find_touching(mesh_, around_, walk_.proxy(), probe_, Skin<T>::kCorner, list);
        if (!(list.corner_distance <= Skin<T>::kCorner))
            return;
        const Base base{list.corner, Skin<T>::kWidth * T(0.5)};
        Way steepest;
        if (!next_way(list, base, any_way(), steepest))
            return;
        const Vector<T> pull = probe_ - base.place;
        if (dot(list.normals[steepest.one], pull) + dot(list.normals[steepest.other], pull) <= T(0))
            walk_.jump(stride(list, base, steepest));
    }

    T depth() const noexcept {
        const Vector<T> way = probe_ - walk_.proxy();
        return std::sqrt(dot(way, way));
    }

    static Way any_way() noexcept { return {Vector<T>(T(0)), std::numeric_limits<T>::max(), 0, 0}; }

    bool slide() noexcept {
        Touching<T> list;
        find_touching(mesh_, around_, walk_.proxy(), probe_, Skin<T>::kNear, list);
        const Base base{walk_.proxy(), Skin<T>::kNear * T(2)};
        const Walk before = walk_;
        Way next, last = any_way();
        while (effort_ < kMostEffort && next_way(list, base, last, next)) {
            const unsigned substeps = walk_.substeps();
            const bool closer = tries(list, base, next, before);
            effort_ += list.near * (walk_.substeps() - substeps + kTryEffort);
            if (closer)
                return true;
            last = next;
        }
        return false;
    }

    /// The steepest way that comes after the last one.
    bool next_way(const Touching<T>& list, const Base& base, const Way& last, Way& next) const noexcept {
        const Vector<T> pull = probe_ - base.place;
        next.gain = std::sqrt(dot(pull, pull)) * T(1e-7);
        bool found = false;
        for (layout::uint i = 0; i < list.count; ++i)
            for (layout::uint j = i; j < list.count; ++j)
                found = offer(list, base, i, j, last, next) || found;
        return found;
    }

    /// Whether the way along planes i and j (or along one, if they are the same) comes after the last one tried and
    /// before the best of those to try.
    bool offer(const Touching<T>& list, const Base& base, layout::uint i, layout::uint j, const Way& last,
               Way& next) const noexcept {
        const Vector<T> pull = probe_ - base.place;
        Way way;
        way.one = i;
        way.other = j;
        if (i == j) {
            way.direction = normalised(Vector<T>(pull - dot(pull, list.normals[i]) * list.normals[i]));
        } else {
            const Vector<T> line = cross(list.normals[i], list.normals[j]);
            if (!(dot(line, line) > T(1e-10)))
                return false;
            way.direction = normalised(line);
            if (dot(way.direction, pull) < T(0))
                way.direction = -way.direction;
        }
        way.gain = dot(way.direction, pull);
        const auto precedes = [](const Way& a, const Way& b) {
            return a.gain > b.gain || (a.gain == b.gain && (a.one < b.one || (a.one == b.one && a.other < b.other)));
        };
        if (!precedes(last, way) || !(way.gain > next.gain) || !on_surface(list, base, way))
            return false;
        next = way;
        return true;
    }

    /// Whether a stride of this way leads over the triangles that it was made from.
    bool on_surface(const Touching<T>& list, const Base& base, const Way& way) const noexcept {
        const Vector<T> place = base.place + kStride<T> * way.direction;
        for (const layout::uint i : {way.one, way.other}) {
            const TrianglePoint<T> nearest = nearest_on_triangle(place, triangle_at(mesh_, list.triangles[i]));
            if (!(nearest.square <= base.tolerance * base.tolerance))
                return false;
        }
        return true;
    }

    /// A stride along the way, a skin off its planes.
    Vector<T> stride(const Touching<T>& list, const Base& base, const Way& way) const noexcept {
        const Vector<T> there = base.place + kStride<T> * way.direction;
        HalfSpace<T> planes[2];
        for (layout::uint i = 0; i < 2; ++i) {
            const layout::uint touch = i == 0 ? way.one : way.other;
            const std::size_t corner = mesh_.triangle_corners[3 * std::size_t(list.triangles[touch])];
            const Vector<T> normal = list.normals[touch];
            planes[i] = {normal, Skin<T>::kWidth - dot(normal, there - vector_at(mesh_.vertices, corner)), i};
        }
        const Vector<T> still(T(0));
        return there +
               (way.one == way.other ? onto_plane(still, planes[0]) : onto_line(still, planes[0], planes[1])).vector;
    }

    bool tries(const Touching<T>& list, const Base& base, const Way& way, const Walk& before) noexcept {
        Vector<T> aside = way.direction;
        if (keep_within(list, aside)) {
            walk_.nudge(aside);
            follow();
            if (walk_.gain_since(before.proxy()) > kGain)
                return true;
            walk_.put_back(before);
        }
        if (walk_.jump(stride(list, base, way))) {
            follow();
            if (walk_.gain_since(before.proxy()) > kGain)
                return true;
        }
        walk_.put_back(before);
        return false;
    }

    /// The way along what is nearest of all that touches, a skin long; false if there is none.
    static bool keep_within(const Touching<T>& list, Vector<T>& way) noexcept {
        const T tolerance = T(16) * std::numeric_limits<T>::epsilon();
        Projection<T> result;
        const bool found = project(way, one_tolerance(tolerance), result, [&](const Vector<T>& v, HalfSpace<T>& space) {
            T most = tolerance;
            for (layout::uint i = 0; i < list.count; ++i) {
                const T violation = -dot(list.aways[i], v);
                if (violation > most) {
                    most = violation;
                    space = {list.aways[i], T(0), i};
                }
            }
            return most > tolerance;
        });
        const T left = std::sqrt(dot(result.vector, result.vector));
        if (!found || !(left > T(1e-4)))
            return false;
        way = result.vector * (Skin<T>::kWidth / left);
        return true;
    }

    const layout::MeshView<T>& mesh_;
    Neighbourhood<T>& around_;
    const Vector<T> probe_;
    Walk& walk_;
    layout::uint effort_ = 0; /* looks at triangles */
};

} // namespace forceshade::reference
