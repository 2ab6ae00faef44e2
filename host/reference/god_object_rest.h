// L6: a god-object at rest: the directions of descent that lead on from a corner or an edge, the facets that constrain
// it, and its contact with them.
#pragma once

#include "host/reference/god_object_planes.h"
#include "host/reference/god_object_walk.h"
#include "host/reference/mesh_neighbourhood.h"

namespace forceshade::reference {

/// A direction of descent over a triangle's face, or along its edge.
template <typename T> struct Descent {
    Vector<T> direction{T(0)};                   /* unit */
    T gain = std::numeric_limits<T>::infinity(); /* towards the probe, per length */
    layout::uint triangle = 0;
    layout::uint edge = 3; /* 3: over the face */
};

/// How near a corner a proxy may be kept off it by folds there narrower than the skin.
template <typename T> constexpr T kFold = Skin<T>::kWidth* T(Skin<T>::kDouble ? 4096 : 32);

/// Where descents begin: a corner of the mesh, or a place on or near its surface. Places within reach of it count as
/// the same.
template <typename T> struct StartPoint {
    Vector<T> place;
    T reach;
    Vector<T> out; /* unit, away from the surface, on the proxy's side; 0 if not known */
    bool corner;
    layout::uint vertex; /* of a corner */
};

/// The nearest corner of the mesh within reach, if any; seen from the front or the back of the triangles
/// there.
template <typename T>
StartPoint<T> nearest_corner(const layout::MeshView<T>& mesh, Neighbourhood<T>& neighbourhood, const Vector<T>& place,
                             T reach, bool front) noexcept {
    StartPoint<T> crossing{place, Skin<T>::kWidth * T(0.5), Vector<T>(T(0)), false, 0};
    T nearest = reach * reach;
    visit_near(mesh, neighbourhood, Move<T>{place, Vector<T>(T(0)), T(0)}, [&](layout::uint index) {
        for (layout::uint i = 0; i < 3; ++i) {
            const layout::uint other = mesh.triangle_corners[3 * std::size_t(index) + i];
            const Vector<T> off = vector_at(mesh.vertices, other) - place;
            const T square = dot(off, off);
            if (!(square < nearest) && (square > nearest || !crossing.corner || other >= crossing.vertex))
                continue;
            nearest = square;
            crossing.vertex = other;
            crossing.corner = true;
        }
    });
    if (!crossing.corner)
        return crossing;
    crossing.place = vector_at(mesh.vertices, crossing.vertex);
    const Vector<T> normal = normalised(vector_at(mesh.vertex_pseudonormals, crossing.vertex));
    crossing.out = front ? normal : -normal;
    return crossing;
}

/// The steepest of a triangle's descents from a starting point on it that gain less than `below`, if one gains more
/// than `best`.
template <typename T> struct DescentSearch {
    const layout::MeshView<T>& mesh;
    const StartPoint<T>& from;
    const Vector<T> pull; /* to the probe */
    T below;
    Descent<T> best;
    bool found = false;

    void offer(layout::uint index) noexcept {
        const Triangle<T> triangle = triangle_at(mesh, index);
        if (!has_corner(index) && !(nearest_on_triangle(from.place, triangle).square <= from.reach * from.reach))
            return;
        offer_face(triangle, index);
        for (layout::uint i = 0; i < 3; ++i)
            offer_edge(triangle, index, i);
    }

private:
    bool has_corner(layout::uint index) const noexcept {
        const layout::uint* corners = &mesh.triangle_corners[3 * std::size_t(index)];
        return from.corner && (corners[0] == from.vertex || corners[1] == from.vertex || corners[2] == from.vertex);
    }

    /// Over the face, away from the edges that the starting point is on.
    void offer_face(const Triangle<T>& triangle, layout::uint index) noexcept {
        const Vector<T> displacement = pull - dot(pull, triangle.normal) * triangle.normal;
        for (layout::uint i = 0; i < 3; ++i) {
            const Vector<T> edge = triangle.corners[(i + 1) % 3] - triangle.corners[i];
            const Vector<T> inward = cross(triangle.normal, edge);
            const T inside = dot(inward, from.place - triangle.corners[i]);
            const T most = from.reach * std::sqrt(dot(edge, edge));
            if (inside <= most && !(dot(inward, displacement) > T(0)))
                return;
        }
        offer_direction(normalised(displacement), index, 3);
    }

    /// Along an edge that the starting point is on, to the end that is nearer to the probe.
    void offer_edge(const Triangle<T>& triangle, layout::uint index, layout::uint i) noexcept {
        const Vector<T>& start = triangle.corners[i];
        const Vector<T>& end = triangle.corners[(i + 1) % 3];
        const T rate = dot(end - start, pull);
        // Both of the edge's triangles walk it in the same direction.
        if (!(rate * rate >= best.gain * best.gain * dot(end - start, end - start) * T(0.99)))
            return;
        const Vector<T> displacement = normalised(Vector<T>(end - start));
        const T along = dot(displacement, from.place - start);
        const Vector<T> off = from.place - start - along * displacement;
        if (!(dot(off, off) <= from.reach * from.reach))
            return;
        const bool forwards = dot(displacement, pull) > T(0);
        const Vector<T>& goal = forwards ? end : start;
        if (dot(goal - from.place, goal - from.place) > T(16) * from.reach * from.reach)
            offer_direction(forwards ? displacement : -displacement, index, i);
    }

    void offer_direction(const Vector<T>& direction, layout::uint index, layout::uint edge) noexcept {
        const T gain = dot(direction, pull);
        if (!(gain < below) || !(gain >= best.gain))
            return;
        if (found && gain == best.gain && !comes_before(mesh, index, best.triangle))
            return;
        best = {direction, gain, index, edge};
        found = true;
    }
};

/// The steepest descent that is less steep than the last one, of the lowest facet and triangle among equals. False if
/// none gains as much as `least`.
template <typename T>
bool next_descent(const layout::MeshView<T>& mesh, Neighbourhood<T>& neighbourhood, const StartPoint<T>& from,
                  const Vector<T>& probe, T least, Descent<T>& descent) noexcept {
    DescentSearch<T> search{mesh, from, probe - from.place, descent.gain, {Vector<T>(T(0)), least, 0, 3}};
    visit_near(mesh, neighbourhood, Move<T>{from.place, Vector<T>(T(0)), T(0)},
               [&](layout::uint index) { search.offer(index); });
    if (search.found)
        descent = search.best;
    return search.found;
}

/// Point at distance `length` along a descent, a skin off the surface there on the side of `normal`, which is square to
/// the descent's triangle.
template <typename T>
Vector<T> place_along(const layout::MeshView<T>& mesh, const StartPoint<T>& from, const Descent<T>& descent, T length,
                      const Vector<T>& normal) noexcept {
    const std::size_t first = 3 * std::size_t(descent.triangle);
    const Vector<T> there = from.place + length * descent.direction;
    const Vector<T> corner = vector_at(mesh.vertices, mesh.triangle_corners[first + descent.edge % 3]);
    const HalfSpace<T> one{normal, Skin<T>::kWidth - dot(normal, there - corner), 0};
    const Vector<T> still(T(0));
    const layout::uint across = descent.edge < 3 ? mesh.triangle_neighbours[first + descent.edge] : layout::kMeshBorder;
    if (across == layout::kMeshBorder || (across & layout::kMeshManyBit) != 0)
        return there + onto_plane(still, one).vector;
    // The edge's other triangle, whose corner off the edge shows to which side it folds.
    const layout::uint begin = mesh.triangle_corners[first + descent.edge];
    const layout::uint end = mesh.triangle_corners[first + (descent.edge + 1) % 3];
    layout::uint i = 0;
    while (i < 2 && (mesh.triangle_corners[3 * std::size_t(across) + i] == begin ||
                     mesh.triangle_corners[3 * std::size_t(across) + i] == end))
        ++i;
    const bool turned = mesh.triangle_corners[3 * std::size_t(across) + (i + 1) % 3] == begin;
    const bool reversed = dot(normal, vector_at(mesh.triangle_normals, descent.triangle)) < T(0);
    const Vector<T> plain = vector_at(mesh.triangle_normals, across);
    const Vector<T> beyond = turned == reversed ? plain : -plain;
    const Vector<T> apex = vector_at(mesh.vertices, mesh.triangle_corners[3 * std::size_t(across) + i]);
    if (dot(normal, apex - corner) > T(0)) {
        const HalfSpace<T> other{beyond, Skin<T>::kWidth - dot(beyond, there - corner), 1};
        const Projection<T> valley = onto_line(still, one, other);
        return there + (valley.count > 0 ? valley : onto_plane(still, one)).vector;
    }
    return there + Skin<T>::kWidth * normalised(Vector<T>(normal + beyond));
}

/// The result of an update.
template <typename T> struct GodObjectContact {
    Vector<T> proxy;           /* on the surface; the probe itself out of contact */
    layout::uint count;        /* facets that constrain the proxy */
    layout::uint facets[3];    /* the lowest id first; one may come twice where a facet is not flat */
    layout::uint triangles[3]; /* the triangle of each */
    Vector<T> normals[3];      /* 1: unit normals of the triangles, towards the proxy's side */
    bool touching;             /* count > 0 */
    bool by_distance;          /* no planes define the contact: it is the place nearest to where the walk ended */
    bool finished;             /* false: ended before it converged; the proxy is on its side nevertheless */
    unsigned substeps;         /* straight pieces walked before the last, and looks taken */
};

template <typename T> GodObjectContact<T> out_of_contact(const Vector<T>& probe) noexcept {
    GodObjectContact<T> contact; // no zeros beyond count: every update comes here
    contact.proxy = probe;
    contact.count = contact.substeps = 0;
    contact.touching = contact.by_distance = false;
    contact.finished = true;
    return contact;
}

/// A probe less deep than rounding makes it is out of contact.
template <typename T> T touch_tolerance(const Vector<T>& probe) noexcept {
    return T(16) * std::numeric_limits<T>::epsilon() * (T(1) + largest_coordinate(probe));
}

/// Adds to a probe out of contact what contact_of() finds for one facet, the most common case.
template <typename T>
void touch_one(const layout::MeshView<T>& mesh, layout::uint triangle, const Vector<T>& normal, const Vector<T>& corner,
               const Vector<T>& probe, GodObjectContact<T>& contact) noexcept {
    const T depth = dot(normal, corner - probe);
    if (!(depth > touch_tolerance(probe)))
        return;
    const Vector<T> place = probe + depth * normal;
    contact.proxy = place + dot(normal, corner - place) * normal;
    contact.count = 1;
    contact.touching = true;
    contact.triangles[0] = triangle;
    contact.facets[0] = mesh.triangle_facets[triangle];
    contact.normals[0] = normal;
}

/// Adds the facet of a triangle that constrains the proxy.
template <typename T>
void add_facet(const layout::MeshView<T>& mesh, layout::uint triangle, const Vector<T>& normal,
               GodObjectContact<T>& contact) noexcept {
    const layout::uint facet = mesh.triangle_facets[triangle];
    layout::uint place = contact.count++;
    for (; place > 0 && contact.facets[place - 1] > facet; --place) {
        contact.facets[place] = contact.facets[place - 1];
        contact.triangles[place] = contact.triangles[place - 1];
        contact.normals[place] = contact.normals[place - 1];
    }
    contact.facets[place] = facet;
    contact.triangles[place] = triangle;
    contact.normals[place] = normal;
    contact.touching = true;
}

/// The planes of up to three triangles that constrain a proxy.
template <typename T> struct ConstrainingFaces {
    layout::uint triangles[3];
    Vector<T> normals[3];
    layout::uint count = 0;
};

/// The facets whose planes keep the probe back, and the nearest point to the probe in front of them: the proxy without
/// its skin, as seen from `origin`, near which rounding is least. Where rounding leaves no point in front of them all,
/// one in front of some: a Certificate decides.
template <typename T>
[[nodiscard]] GodObjectContact<T> contact_of(const layout::MeshView<T>& mesh, const ConstrainingFaces<T>& faces,
                                             const Vector<T>& probe, const Vector<T>& origin) noexcept {
    GodObjectContact<T> contact = out_of_contact(probe);
    HalfSpace<T> planes[3];
    for (layout::uint i = 0; i < faces.count; ++i) {
        const std::size_t corner = mesh.triangle_corners[3 * std::size_t(faces.triangles[i])];
        planes[i] = {faces.normals[i], dot(faces.normals[i], vector_at(mesh.vertices, corner) - origin), i};
    }
    const T tolerance = touch_tolerance(probe);
    Projection<T> projection;
    (void)project(Vector<T>(probe - origin), one_tolerance(tolerance), projection,
                  [&](const Vector<T>& shift, HalfSpace<T>& space) {
                      T most = tolerance;
                      for (layout::uint i = 0; i < faces.count; ++i) {
                          const T violation = planes[i].slack - dot(planes[i].normal, shift);
                          if (violation > most) {
                              most = violation;
                              space = planes[i];
                          }
                      }
                      return most > tolerance;
                  });
    if (projection.count > 0)
        contact.proxy = origin + projection.vector;
    for (layout::uint i = 0; i < projection.count; ++i) {
        const layout::uint source = projection.active[i].source;
        add_facet(mesh, faces.triangles[source], faces.normals[source], contact);
    }
    return contact;
}

/// Where a proxy rests, all that is kept of it.
template <typename T> struct Rest {
    Vector<T> proxy{T(0)};              /* a skin away from every triangle; the probe itself out of contact */
    layout::uint triangles[3]{0, 0, 0}; /* that constrain it */
    layout::uint count = 0;
    bool cornered = false; /* by edges or corners, or three faces */
};

/// Whether the proxy is in front of the surface: of that feature, of the triangles that constrain it, which is nearest.
template <typename T> bool is_in_front(const layout::MeshView<T>& mesh, const Rest<T>& rest) noexcept {
    Nearest<T> nearest{};
    nearest.square = std::numeric_limits<T>::max();
    for (layout::uint i = 0; i < rest.count; ++i) {
        const layout::uint triangle = rest.triangles[i];
        const TrianglePoint<T> point = nearest_on_triangle(rest.proxy, triangle_at(mesh, triangle));
        if (point.square < nearest.square)
            nearest = {triangle, mesh.triangle_facets[triangle], point.feature, point.offset, point.square};
    }
    return rest.count == 0 || !inside_by_pseudonormal(mesh, nearest);
}

/// Whether a proxy in front of the surface is in front of this triangle. Outside of the triangle its plane does not
/// decide: it may cut through a fold.
template <typename T>
bool is_above(const Triangle<T>& triangle, const TrianglePoint<T>& nearest, const Vector<T>& proxy,
              bool front) noexcept {
    return nearest.feature == layout::kMeshFace ? !(dot(triangle.normal, proxy - triangle.corners[0]) < T(0)) : front;
}

/// How a proxy sees the triangles near it: those seen from the other side of the surface are what is beyond a fold,
/// unless the mesh is not consistently oriented.
struct View {
    bool front, both_sides;
};

/// Finds the triangle near the proxy whose plane a displacement violates most, the lowest facet and triangle first
/// among equals.
template <typename T>
bool most_violated(const layout::MeshView<T>& mesh, Neighbourhood<T>& neighbourhood, const Vector<T>& proxy, View view,
                   const Vector<T>& displacement, T tolerance, HalfSpace<T>& space) noexcept {
    constexpr T kReach = Skin<T>::kNear;
    T most = tolerance;
    bool found = false;
    visit_near(mesh, neighbourhood, Move<T>{proxy, Vector<T>(T(0)), T(0)}, [&](layout::uint index) {
        const Triangle<T> triangle = triangle_at(mesh, index);
        const T height = dot(triangle.normal, proxy - triangle.corners[0]);
        const T rate = dot(triangle.normal, displacement);
        const T pushed = view.both_sides ? std::abs(rate) : (view.front ? -rate : rate);
        if (!(std::abs(height) <= kReach) || !(pushed >= most) || !(pushed > tolerance))
            return;
        const TrianglePoint<T> nearest = nearest_on_triangle(proxy, triangle);
        const bool above = is_above(triangle, nearest, proxy, view.front);
        if (above != view.front && !view.both_sides)
            return;
        const Vector<T> normal = above ? triangle.normal : -triangle.normal;
        const T violation = above ? -rate : rate;
        if (!(violation > T(0)) || !(nearest.square <= kReach * kReach))
            return;
        if (found && violation == most && comes_before(mesh, space.source, index))
            return;
        most = violation;
        space = {normal, T(0), index};
        found = true;
    });
    return found;
}

/// Those of all triangles near the proxy whose planes together constrain it; some of them where rounding leaves no
/// displacement that keeps to them all: a Certificate decides.
template <typename T>
[[nodiscard]] ConstrainingFaces<T> constraining_faces(const layout::MeshView<T>& mesh, Neighbourhood<T>& neighbourhood,
                                                      const Vector<T>& proxy, View view,
                                                      const Vector<T>& probe) noexcept {
    const Vector<T> wish = probe - proxy;
    const T tolerance = T(64) * std::numeric_limits<T>::epsilon() * largest_coordinate(wish);
    Projection<T> all;
    (void)project(wish, one_tolerance(tolerance), all, [&](const Vector<T>& displacement, HalfSpace<T>& space) {
        return most_violated(mesh, neighbourhood, proxy, view, displacement, tolerance, space);
    });
    ConstrainingFaces<T> faces;
    for (; faces.count < all.count; ++faces.count) {
        faces.triangles[faces.count] = all.active[faces.count].source;
        faces.normals[faces.count] = all.active[faces.count].normal;
    }
    return faces;
}

/// How far from the proxy, in skins, the planes that constrain it meet.
template <typename T> T skins_to_planes(const ConstrainingFaces<T>& faces) noexcept {
    HalfSpace<T> planes[3];
    for (layout::uint i = 0; i < faces.count; ++i)
        planes[i] = {faces.normals[i], T(-1), i};
    const Vector<T> still(T(0));
    Projection<T> meeting;
    if (faces.count == 3)
        meeting = onto_corner(still, planes[0], planes[1], planes[2]);
    else if (faces.count == 2)
        meeting = onto_line(still, planes[0], planes[1]);
    return meeting.count > 0 ? std::sqrt(dot(meeting.vector, meeting.vector)) : T(1);
}

/// Whether a triangle stands between two places, but for the share `rest` of the way at its end.
template <typename T>
bool is_blocked(const layout::MeshView<T>& mesh, Neighbourhood<T>& neighbourhood, const Vector<T>& from,
                const Vector<T>& to, T rest) noexcept {
    const Vector<T> displacement = to - from;
    bool blocked = false;
    visit_near(mesh, neighbourhood, Move<T>{from, displacement, T(1)}, [&](layout::uint index) {
        const Triangle<T> triangle = triangle_at(mesh, index);
        const T begin = dot(triangle.normal, from - triangle.corners[0]);
        const T end = dot(triangle.normal, to - triangle.corners[0]);
        const T time = begin / (begin - end);
        if (!(begin * end < T(0)) || time > T(1) - rest)
            return;
        const Vector<T> crossing = from + time * displacement;
        blocked = blocked || nearest_on_triangle(crossing, triangle).square <= Skin<T>::kRest * Skin<T>::kRest;
    });
    return blocked;
}

/// The triangle nearest to a place, of those within twice the skin. False without any.
template <typename T>
bool nearest_near(const layout::MeshView<T>& mesh, Neighbourhood<T>& neighbourhood, const Vector<T>& place,
                  layout::uint& triangle) noexcept {
    T nearest = std::numeric_limits<T>::max();
    bool found = false;
    visit_near(mesh, neighbourhood, Move<T>{place, Vector<T>(T(0)), T(0)}, [&](layout::uint index) {
        const T square = nearest_on_triangle(place, triangle_at(mesh, index)).square;
        if (!(square < nearest) && !(square == nearest && comes_before(mesh, index, triangle)))
            return;
        nearest = square;
        triangle = index;
        found = true;
    });
    return found;
}

/// Whether a pull pushes against planes alone: what of it they leave free is no more than a skin or rounding explain.
template <typename T> bool is_balanced(const GodObjectContact<T>& contact, const Vector<T>& pull) noexcept {
    const T square = dot(pull, pull), tolerance = Skin<T>::kRest + T(0x1p-12) * std::sqrt(square);
    Projection<T> left;
    // Where rounding leaves none, what was found last is small or it is not.
    (void)project(pull, one_tolerance(tolerance), left, [&](const Vector<T>& vector, HalfSpace<T>& space) {
        for (layout::uint i = 0; i < contact.count; ++i)
            if (dot(contact.normals[i], vector) < -tolerance) {
                space = {contact.normals[i], T(0), i};
                return true;
            }
        return false;
    });
    const T most = T(2) * Skin<T>::kWidth + T(0x1p-6) * std::sqrt(square);
    return dot(left.vector, left.vector) <= most * most;
}

/// The certificate of a contact, given the proxy that the walk took to its side, crossing no triangle: it is where the
/// proxy is, but for the skin, or where the planes that constrain it meet; it is no further from the probe than the
/// proxy; and no triangle is between the two. Without a contact no triangle is between the proxy and the probe.
template <typename T> class Certificate {
public:
    Certificate(const layout::MeshView<T>& mesh, Neighbourhood<T>& neighbourhood, const Vector<T>& proxy,
                const Vector<T>& probe) noexcept
        : mesh_(mesh), neighbourhood_(neighbourhood), proxy_(proxy), probe_(probe) {}

    /// Of a contact with some of these faces, which together constrain the proxy. Moves it by what rounding explains.
    [[nodiscard]] bool holds(GodObjectContact<T>& contact, const ConstrainingFaces<T>& faces) const noexcept {
        return contact.touching ? is_at_proxy(contact, faces) : is_reached();
    }

    /// Whether a contact is where the proxy is, but for the skin: then it holds.
    bool is_beside_proxy(const GodObjectContact<T>& contact) const noexcept {
        const Vector<T> shift = contact.proxy - proxy_;
        return dot(shift, shift) <= kBeside * kBeside;
    }

    /// Whether a place is further from the probe than the proxy is, by more than its skin.
    bool has_grown(const Vector<T>& place) const noexcept {
        const Vector<T> displacement = place - proxy_, both = (probe_ - proxy_) + (probe_ - place);
        return !(dot(displacement, both) >= -kBeside * std::sqrt(dot(both, both)));
    }

private:
    static constexpr T kBeside = T(2) * Skin<T>::kWidth;

    bool is_at_proxy(GodObjectContact<T>& contact, const ConstrainingFaces<T>& faces) const noexcept {
        if (is_beside_proxy(contact))
            return true;
        const Vector<T> shift = contact.proxy - proxy_;
        const T length = std::sqrt(dot(shift, shift)), skins = T(1) + skins_to_planes(faces);
        return length <= T(4) * skins * Skin<T>::kWidth && move_onto_facet(contact, faces, skins) &&
               !has_grown(contact.proxy) && !are_convex(contact) &&
               // More than a skin before its end, and a hundredth of the distance in acute corners.
               !is_blocked(mesh_, neighbourhood_, proxy_, contact.proxy, T(0.01) + Skin<T>::kWidth / length);
    }

    /// Planes may meet where their triangles do not reach: a contact no further from one of them than rounding of so
    /// acute a corner explains is moved there, where all of them constrain it.
    bool move_onto_facet(GodObjectContact<T>& contact, const ConstrainingFaces<T>& faces, T skins) const noexcept {
        T nearest = kBeside + touch_tolerance(contact.proxy) * skins;
        nearest = nearest * nearest;
        Vector<T> offset(T(0));
        bool found = false;
        for (layout::uint i = 0; i < contact.count; ++i) {
            const TrianglePoint<T> point = nearest_on_triangle(contact.proxy, triangle_at(mesh_, contact.triangles[i]));
            if (!(point.square <= nearest))
                continue;
            nearest = point.square;
            offset = point.offset;
            found = true;
        }
        if (!found || nearest <= kBeside * kBeside)
            return found;
        contact.proxy += offset;
        contact.count = 0;
        for (layout::uint i = 0; i < faces.count; ++i)
            add_facet(mesh_, faces.triangles[i], faces.normals[i], contact);
        return is_balanced(contact, Vector<T>(probe_ - contact.proxy));
    }

    /// Whether all triangles are behind each other's planes: over an edge between two such a proxy slides, so their
    /// planes do not both constrain it.
    bool are_convex(const GodObjectContact<T>& contact) const noexcept {
        bool convex = contact.count > 1;
        for (layout::uint i = 0; i < contact.count; ++i)
            for (layout::uint j = i + 1; j < contact.count; ++j)
                convex = convex && is_behind_plane(contact, i, j) && is_behind_plane(contact, j, i);
        return convex;
    }

    bool is_behind_plane(const GodObjectContact<T>& contact, layout::uint one, layout::uint plane) const noexcept {
        const Triangle<T> triangle = triangle_at(mesh_, contact.triangles[one]);
        const Vector<T> corner = triangle_at(mesh_, contact.triangles[plane]).corners[0];
        for (const Vector<T>& other : triangle.corners)
            if (dot(contact.normals[plane], other - corner) > Skin<T>::kPlace)
                return false;
        return true;
    }

    bool is_reached() const noexcept {
        const Vector<T> pull = probe_ - proxy_;
        return dot(pull, pull) <= kBeside * kBeside || !is_blocked(mesh_, neighbourhood_, proxy_, probe_, T(0));
    }

    const layout::MeshView<T>& mesh_;
    Neighbourhood<T>& neighbourhood_;
    const Vector<T>& proxy_;
    const Vector<T>& probe_;
};

/// The contact at the nearest place of the triangles that constrain a proxy, where no planes give a better one: on its
/// side and a skin away. Unfinished if these triangles would let it go on. No contact if no triangle is between proxy
/// and probe.
template <typename T>
[[nodiscard]] GodObjectContact<T> contact_by_distance(const layout::MeshView<T>& mesh, Neighbourhood<T>& neighbourhood,
                                                      const Vector<T>& proxy, const ConstrainingFaces<T>& faces,
                                                      const Vector<T>& probe) noexcept {
    GodObjectContact<T> contact = out_of_contact(probe);
    if (!is_blocked(mesh, neighbourhood, proxy, probe, T(0)))
        return contact;
    T nearest = std::numeric_limits<T>::max();
    for (layout::uint i = 0; i < faces.count; ++i) {
        const TrianglePoint<T> point = nearest_on_triangle(proxy, triangle_at(mesh, faces.triangles[i]));
        if (point.square < nearest) {
            nearest = point.square;
            contact.proxy = proxy + point.offset;
        }
        add_facet(mesh, faces.triangles[i], faces.normals[i], contact);
    }
    contact.by_distance = true;
    contact.finished = is_balanced(contact, Vector<T>(probe - contact.proxy));
    return contact;
}

/// The contact of a proxy at rest on edges or corners, from what is kept of the rest.
template <typename T>
[[nodiscard]] GodObjectContact<T> contact_at_corner(const layout::MeshView<T>& mesh, Neighbourhood<T>& neighbourhood,
                                                    const Rest<T>& rest, const Vector<T>& probe) noexcept {
    const bool front = is_in_front(mesh, rest);
    const Certificate<T> certificate(mesh, neighbourhood, rest.proxy, probe);
    GodObjectContact<T> contact;
    for (const bool both_sides : {false, true}) {
        const ConstrainingFaces<T> all =
            constraining_faces(mesh, neighbourhood, rest.proxy, View{front, both_sides}, probe);
        for (const Vector<T>& origin : {probe, rest.proxy}) {
            contact = contact_of(mesh, all, probe, origin);
            if ((contact.touching || both_sides) && certificate.holds(contact, all))
                return contact;
        }
    }
    ConstrainingFaces<T> faces;
    for (; faces.count < rest.count; ++faces.count) {
        const layout::uint triangle = rest.triangles[faces.count];
        const Triangle<T> shape = triangle_at(mesh, triangle);
        const bool above = is_above(shape, nearest_on_triangle(rest.proxy, shape), rest.proxy, front);
        faces.triangles[faces.count] = triangle;
        faces.normals[faces.count] = above ? shape.normal : -shape.normal;
    }
    contact = contact_by_distance(mesh, neighbourhood, rest.proxy, faces, probe);
    return contact;
}

/// The contact of a proxy in the open or constrained by faces alone, where a walk came to rest.
template <typename T, typename Walk>
[[nodiscard]] GodObjectContact<T> contact_at_faces(const layout::MeshView<T>& mesh, Neighbourhood<T>& neighbourhood,
                                                   const Walk& walk, const Vector<T>& probe) noexcept {
    const Projection<T>& resting = walk.resting();
    const Certificate<T> certificate(mesh, neighbourhood, walk.proxy(), probe);
    GodObjectContact<T> contact = out_of_contact(probe); // one object, so that it is built where it is returned
    if (resting.count == 0)
        return contact;
    if (resting.count == 1) {
        const Touch<T>& touch = walk.touch(resting.active[0].source);
        touch_one(mesh, touch.index, touch.face, touch.triangle.corners[0], probe, contact);
        // Without a contact the probe is within the skin of the plane on which the proxy rests.
        if (!contact.touching || certificate.is_beside_proxy(contact))
            return contact;
    }
    ConstrainingFaces<T> faces;
    for (; faces.count < resting.count; ++faces.count) {
        const Touch<T>& touch = walk.touch(resting.active[faces.count].source);
        faces.triangles[faces.count] = touch.index;
        faces.normals[faces.count] = touch.face;
    }
    for (const Vector<T>& origin : {probe, walk.proxy()}) {
        contact = contact_of(mesh, faces, probe, origin);
        if (certificate.holds(contact, faces))
            return contact;
    }
    contact = contact_by_distance(mesh, neighbourhood, walk.proxy(), faces, probe);
    return contact;
}

} // namespace forceshade::reference
