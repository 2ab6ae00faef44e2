// L6: the god-object (Zilles & Salisbury 1995) on a polygon mesh, converged fully in every update.
#pragma once

#include "host/reference/god_object_rest.h"

namespace forceshade::reference {

/// The state of one path, in the mesh's frame. As constructed: a path that has not begun.
template <typename T> struct GodObject {
    Vector<T> proxy{T(0)};              /* a skin away from every triangle; the probe itself out of contact */
    layout::uint triangles[3]{0, 0, 0}; /* that held it at the last update */
    layout::uint count = 0;
    bool cornered = false; /* rested at a corner or an edge */
    bool started = false;
};

/// What an update found.
template <typename T> struct GodObjectContact {
    Vector<T> proxy;           /* on the surface; the probe itself out of contact */
    layout::uint count;        /* facets that hold the proxy */
    layout::uint facets[3];    /* the lowest id first; one may come twice where a facet is not flat */
    layout::uint triangles[3]; /* the triangle of each */
    Vector<T> normals[3];      /* 1: unit normals of the triangles, towards the proxy's side */
    bool touching;             /* count > 0 */
    bool finished;             /* false: ended before it converged; the proxy is on its side all the same */
    unsigned substeps;         /* straight pieces walked before the last, and looks taken */
};

template <typename T> bool is_finite(const Vector<T>& v) noexcept {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

template <typename T> GodObjectContact<T> out_of_contact(const Vector<T>& probe) noexcept {
    GodObjectContact<T> contact{};
    contact.proxy = probe;
    contact.finished = true;
    return contact;
}

/// Begins a path: the proxy is the probe, or a skin away from what it touches, on the side where it is; in front of a
/// triangle if it is on it exactly.
template <typename T>
void begin_path(const layout::MeshView<T>& mesh, GodObject<T>& state, Neighbourhood<T>& around,
                const Vector<T>& probe) noexcept {
    constexpr int kTries = 64;
    state.proxy = probe;
    state.count = 0;
    state.cornered = false;
    state.started = true;
    if (largest_of(probe) > T(kRegion))
        return;
    for (int i = 0; i < kTries; ++i) {
        Touch<T> nearest{}, touch{};
        nearest.distance = Skin<T>::kImpact;
        visit_near(mesh, around, Move<T>{state.proxy, Vector<T>(T(0)), T(0)}, [&](layout::uint index) {
            begin_touch(mesh, index, touch);
            look(touch, state.proxy);
            const bool first =
                touch.distance == nearest.distance && mesh.triangle_facets[index] < mesh.triangle_facets[nearest.index];
            if (touch.distance < nearest.distance || first)
                nearest = touch;
        });
        if (!(nearest.distance < Skin<T>::kImpact))
            return;
        const Vector<T> out = nearest.distance > Skin<T>::kRest ? nearest.away : nearest.face;
        state.proxy += (Skin<T>::kWidth - nearest.distance) * out;
    }
}

/// A probe less deep than rounding makes it is out of contact.
template <typename T> T touch_tolerance(const Vector<T>& probe) noexcept {
    return T(16) * std::numeric_limits<T>::epsilon() * (T(1) + largest_of(probe));
}

/// The same as contact_of() for one facet, the most common case.
template <typename T>
GodObjectContact<T> contact_of_one(const layout::MeshView<T>& mesh, layout::uint triangle, const Vector<T>& normal,
                                   const Vector<T>& corner, const Vector<T>& probe) noexcept {
    GodObjectContact<T> contact = out_of_contact(probe);
    const T depth = dot(normal, corner - probe);
    if (!(depth > touch_tolerance(probe)))
        return contact;
    contact.proxy = probe + depth * normal;
    contact.proxy += dot(normal, corner - contact.proxy) * normal;
    contact.count = 1;
    contact.touching = true;
    contact.triangles[0] = triangle;
    contact.facets[0] = mesh.triangle_facets[triangle];
    contact.normals[0] = normal;
    return contact;
}

/// The facets whose planes hold the probe back, and the nearest point to the probe in front of them: the proxy without
/// its skin.
template <typename T>
GodObjectContact<T> contact_of(const layout::MeshView<T>& mesh, const layout::uint* triangles, const Vector<T>* normals,
                               layout::uint count, const Vector<T>& probe) noexcept {
    GodObjectContact<T> contact = out_of_contact(probe);
    HalfSpace<T> planes[3];
    for (layout::uint i = 0; i < count; ++i) {
        const std::size_t corner = mesh.triangle_corners[3 * std::size_t(triangles[i])];
        planes[i] = {normals[i], dot(normals[i], vector_at(mesh.vertices, corner) - probe), i};
    }
    const T tolerance = touch_tolerance(probe);
    Projection<T> projection;
    project(Vector<T>(T(0)), tolerance, projection, [&](const Vector<T>& shift, HalfSpace<T>& space) {
        T most = tolerance;
        for (layout::uint i = 0; i < count; ++i) {
            const T violation = planes[i].slack - dot(planes[i].normal, shift);
            if (violation > most) {
                most = violation;
                space = planes[i];
            }
        }
        return most > tolerance;
    });
    contact.proxy = probe + projection.vector;
    contact.count = projection.count;
    contact.touching = contact.count > 0;
    for (layout::uint i = 0; i < contact.count; ++i) {
        const layout::uint source = projection.held[i].source;
        layout::uint place = i;
        const layout::uint facet = mesh.triangle_facets[triangles[source]];
        for (; place > 0 && contact.facets[place - 1] > facet; --place) {
            contact.facets[place] = contact.facets[place - 1];
            contact.triangles[place] = contact.triangles[place - 1];
            contact.normals[place] = contact.normals[place - 1];
        }
        contact.facets[place] = facet;
        contact.triangles[place] = triangles[source];
        contact.normals[place] = normals[source];
    }
    return contact;
}

/// The contact of a proxy at rest. On rounded edges the planes of all touching triangles together hold it.
template <typename T, typename Walk>
GodObjectContact<T> contact_at_rest(const layout::MeshView<T>& mesh, Neighbourhood<T>& around, const Walk& walk,
                                    const Vector<T>& probe) noexcept {
    const Projection<T>& resting = walk.resting();
    if (resting.count == 1 && walk.held_by_face(0)) {
        const Touch<T>& touch = walk.touch(resting.held[0].source);
        return contact_of_one(mesh, touch.index, touch.face, touch.triangle.corners[0], probe);
    }
    layout::uint triangles[3];
    Vector<T> normals[3];
    bool faces = true;
    for (layout::uint i = 0; i < resting.count; ++i) {
        triangles[i] = walk.touch(resting.held[i].source).index;
        normals[i] = walk.touch(resting.held[i].source).face;
        faces = faces && walk.held_by_face(i);
    }
    if (faces)
        return contact_of(mesh, triangles, normals, resting.count, probe);
    Touching<T> list;
    Projection<T> all;
    find_touching(mesh, around, walk.proxy(), Skin<T>::kNear, list);
    allowed_by_all(list, probe - walk.proxy(), all);
    for (layout::uint i = 0; i < all.count; ++i) {
        triangles[i] = list.triangles[all.held[i].source];
        normals[i] = list.normals[all.held[i].source];
    }
    return contact_of(mesh, triangles, normals, all.count, probe);
}

/// L6: the probe takes its new position, in the mesh's frame; the proxy follows until nothing lets it come closer,
/// crossing no triangle. A probe that is not finite changes nothing and is out of contact. No allocation.
template <typename T, typename Trace = NoTrace>
GodObjectContact<T> update(const layout::MeshView<T>& mesh, GodObject<T>& state, Neighbourhood<T>& around,
                           const Vector<T>& probe, const Trace& trace = {}) noexcept {
    if (!is_finite(probe))
        return out_of_contact(probe);
    if (!state.started)
        begin_path(mesh, state, around, probe);
    Walk<T, Trace> walk(mesh, around, state.proxy, probe, trace);
    for (layout::uint i = 0; i < state.count; ++i)
        walk.remember(state.triangles[i]);
    Settler<T, Walk<T, Trace>> settler(mesh, around, probe, walk);
    settler.run(state.cornered);
    GodObjectContact<T> contact = contact_at_rest(mesh, around, walk, probe);
    contact.finished = walk.finished();
    contact.substeps = walk.substeps();
    state.proxy = walk.proxy();
    state.count = contact.count;
    state.cornered = settler.doubtful();
    for (layout::uint i = 0; i < contact.count; ++i)
        state.triangles[i] = contact.triangles[i];
    return contact;
}

} // namespace forceshade::reference
