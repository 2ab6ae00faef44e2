// L6: what of all triangles near a proxy that rests at edges or corners holds it, step for step as
// host/reference/god_object_held.h. What is near was listed before.
//
// What a loop finds in the device's memory it keeps within a branch that reads it: a driver that goes on with the loop
// for a neighbour computes what stands outside of branches once more, from zeros, and what is used after the loop is that.

// Where a proxy rests, all that is kept of it.
struct Kept {
    real3 proxy;
    uvec3 triangles; // that hold it
    uint count;
    bool cornered; // by edges or corners, or three faces
    bool front; // in front of the surface; known where it is cornered
};

const uint kMostNear = 128u;
uint near_listed[kMostNear]; // twice the triangle, and whether the proxy is in front of it
uint near_count;
bool near_crowded; // there were more

uint kept_triangle(Kept kept, uint i) {
    return i == 0u ? kept.triangles.x : i == 1u ? kept.triangles.y : kept.triangles.z;
}

// What is outward at a point of a triangle: the pseudonormal there.
real3 outward_at(uint index, real3 normal, uint feature) {
    uvec3 corners = triangle_corners(index);
    uvec4 words = triangle_words[2u * index];
    uint corner = feature == kMeshCorner ? corners.x : feature == kMeshCorner + 1u ? corners.y : corners.z;
    uint across = feature == kMeshEdge ? words.y : feature == kMeshEdge + 1u ? words.z : words.w;
    bool many = (across & kMeshManyBit) != 0u;
    real3 outward = normal;
    if (feature >= kMeshCorner)
        outward = vertex_pseudonormal(corner);
    else if (feature >= kMeshEdge && across != kMeshBorder) {
        real3 other = many ? vectors[across & ~kMeshManyBit].xyz : triangle_normal(across);
        outward = many ? other : sum(normal, other);
    }
    return outward;
}

// Whether the proxy is in front of the surface: of that feature, of the triangles that hold it, which is nearest.
bool is_in_front(Kept kept) {
    real square = LARGEST;
    bool front = true;
    uint i = 0u;
    [[dont_unroll]] do {
        if (i < kept.count) {
            uint index = kept_triangle(kept, i);
            Triangle triangle = triangle_at(index);
            TrianglePoint point = nearest_on_triangle(kept.proxy, triangle);
            real3 outward = outward_at(index, triangle.normal, point.feature);
            if (point.square < square) {
                square = point.square;
                front = !(product(point.offset, outward) > ZERO);
            }
        }
        ++i;
        ++spent;
    } while (i < kept.count);
    return front;
}

// Whether a proxy in front of the surface is in front of this triangle. Beside the triangle that is not for the plane
// to tell, which may cut through a fold.
bool is_above(Triangle triangle, TrianglePoint point, real3 proxy, bool front) {
    bool above_plane = !(product(triangle.normal, difference(proxy, triangle.a)) < ZERO);
    return point.feature == kMeshFace ? above_plane : front;
}

Holder holder_of(uint index, Triangle triangle, bool above) {
    real3 normal = above ? triangle.normal : -triangle.normal;
    return Holder(index, normal, triangle.a, product(normal, triangle.normal) < ZERO);
}

// Finds the triangle near the proxy whose plane a way violates most, the lowest facet and triangle first among equals.
bool most_violated(bool front, bool both_sides, real3 way, real tolerance, inout HalfSpace space) {
    real most = tolerance;
    bool found = false;
    uint i = 0u;
    [[dont_unroll]] do {
        if (i < near_count) {
            uint listed = near_listed[i];
            uint index = listed >> 1;
            bool above = (listed & 1u) != 0u;
            real3 normal = triangle_normal(index);
            real rate = product(normal, way);
            real violation = above ? -rate : rate;
            bool more = (both_sides || above == front) && violation > tolerance && violation >= most;
            if (found && violation == most)
                more = more && comes_before(index, space.source >> 1);
            if (more) {
                most = violation;
                space = HalfSpace(above ? normal : -normal, ZERO, listed);
                found = true;
            }
        }
        ++i;
        ++spent;
    } while (i < near_count);
    return found;
}

// Those of all triangles near the proxy whose planes together hold it; none if not `wanted`.
Projection holders_of_all(bool wanted, real3 proxy, bool front, bool both_sides, real3 probe) {
    real3 wish = difference(probe, proxy);
    precise real tolerance = real(64.0LF) * EPSILON * largest_of(wish);
    Projection all = free_projection(wish);
    uint left = kProjectionRounds;
    bool seeking = wanted;
    [[dont_unroll]] do {
        HalfSpace violated = kNoHalfSpace;
        bool violates = most_violated(front, both_sides, all.vector, tolerance, violated) && seeking;
        bool fits = false;
        if (violates)
            fits = hold_also(wish, violated, one_tolerance(tolerance), all);
        --left;
        overrun = overrun || (seeking && spent >= spent_limit);
        seeking = fits && left > 0u && !overrun;
    } while (seeking);
    return all;
}
