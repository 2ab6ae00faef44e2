// L6: what a god-object that came to rest on rounded edges does next, and what holds it.
#pragma once

#include "host/reference/god_object_walk.h"

namespace forceshade::reference {

/// The planes, by facet, of the triangles within reach of the skin, sides as the proxy sees them.
template <typename T> struct Touching {
    static constexpr layout::uint kCapacity = 64;
    layout::uint triangles[kCapacity];
    layout::uint facets[kCapacity];
    Vector<T> normals[kCapacity];
    layout::uint count = 0;
};

template <typename T>
void insert_by_facet(Touching<T>& list, layout::uint triangle, layout::uint facet, const Vector<T>& normal) noexcept {
    layout::uint place = list.count < Touching<T>::kCapacity ? list.count++ : list.count;
    const auto later = [&](layout::uint i) {
        return list.facets[i] > facet || (list.facets[i] == facet && list.triangles[i] > triangle);
    };
    if (place == Touching<T>::kCapacity) {
        if (!later(place - 1))
            return;
        --place;
    }
    for (; place > 0 && later(place - 1); --place) {
        list.triangles[place] = list.triangles[place - 1];
        list.facets[place] = list.facets[place - 1];
        list.normals[place] = list.normals[place - 1];
    }
    list.triangles[place] = triangle;
    list.facets[place] = facet;
    list.normals[place] = normal;
}

template <typename T>
void find_touching(const layout::MeshView<T>& mesh, Neighbourhood<T>& around, const Vector<T>& proxy,
                   Touching<T>& list) noexcept {
    list.count = 0;
    visit_near(mesh, around, Move<T>{proxy, Vector<T>(T(0)), T(0)}, [&](layout::uint index) {
        Touch<T> touch;
        begin_touch(mesh, index, touch);
        look(touch, proxy);
        if (touch.distance <= Skin<T>::kNear && dot(touch.face, touch.face) > T(0))
            insert_by_facet(list, index, mesh.triangle_facets[index], touch.face);
    });
}

/// What of a wish all planes allow together.
template <typename T>
bool allowed_by_all(const Touching<T>& list, const Vector<T>& wish, Projection<T>& result) noexcept {
    const T tolerance = T(64) * std::numeric_limits<T>::epsilon() * largest_of(wish);
    return project(wish, tolerance, result, [&](const Vector<T>& way, HalfSpace<T>& space) {
        T most = tolerance;
        bool found = false;
        for (layout::uint i = 0; i < list.count; ++i) {
            const T violation = -dot(list.normals[i], way);
            if (violation > most) {
                most = violation;
                space = {list.normals[i], T(0), i};
                found = true;
            }
        }
        return found;
    });
}

/// The skin rounds edges, and on the crest of one a proxy may stand where the law would let it slide down either side.
/// Tries the sides, the lowest facet first; keeps the first that brings it closer to the probe.
template <typename T, typename Walk> class Settler {
public:
    Settler(const layout::MeshView<T>& mesh, Neighbourhood<T>& around, const Vector<T>& probe, Walk& walk) noexcept
        : mesh_(mesh), around_(around), probe_(probe), walk_(walk) {}

    void run() noexcept {
        constexpr int kRounds = 16;
        for (int i = 0; i < kRounds && on_edge() && walk_.finished(); ++i)
            if (!slide())
                return;
    }

private:
    T depth() const noexcept {
        const Vector<T> way = probe_ - walk_.proxy();
        return std::sqrt(dot(way, way));
    }

    bool on_edge() const noexcept {
        for (layout::uint i = 0; i < walk_.resting().count; ++i)
            if (!walk_.held_by_face(i))
                return depth() > T(4) * Skin<T>::kWidth;
        return false;
    }

    bool slide() noexcept {
        Touching<T> list;
        const Walk before = walk_;
        const Vector<T> rest = walk_.proxy();
        const T start = depth();
        find_touching(mesh_, around_, rest, list);
        Vector<T> normals[3];
        const layout::uint held = walk_.resting().count;
        for (layout::uint i = 0; i < held; ++i)
            normals[i] = walk_.resting().held[i].normal;
        for (layout::uint i = 0; i < list.count; ++i) {
            Vector<T> way = probe_ - rest;
            way -= dot(way, list.normals[i]) * list.normals[i];
            if (!keep_within(normals, held, way))
                continue;
            walk_.nudge(way);
            walk_.run();
            if (depth() < start - T(4) * Skin<T>::kWidth)
                return true;
            walk_.put_back(before);
        }
        return false;
    }

    /// The way along the planes that hold it, a skin long; false if there is none.
    static bool keep_within(const Vector<T>* normals, layout::uint count, Vector<T>& way) noexcept {
        const T length = std::sqrt(dot(way, way));
        Projection<T> result;
        const T tolerance = length * T(16) * std::numeric_limits<T>::epsilon();
        const bool found = project(way, tolerance, result, [&](const Vector<T>& v, HalfSpace<T>& space) {
            for (layout::uint i = 0; i < count; ++i)
                if (dot(normals[i], v) < -tolerance) {
                    space = {normals[i], T(0), i};
                    return true;
                }
            return false;
        });
        const T left = std::sqrt(dot(result.vector, result.vector));
        if (!found || !(left > T(1e-4) * length))
            return false;
        way = result.vector * (Skin<T>::kWidth / left);
        return true;
    }

    const layout::MeshView<T>& mesh_;
    Neighbourhood<T>& around_;
    const Vector<T> probe_;
    Walk& walk_;
};

} // namespace forceshade::reference
