// L6: the walk of a god-object towards the probe, until no displacement brings it closer, and the triangles near it
// whose half-spaces constrain that.
#pragma once

#include "host/reference/god_object_planes.h"
#include "host/reference/mesh_neighbourhood.h"

namespace forceshade::reference {

/// No displacement is longer, so that no rounding of one is as large as the skin; every one within the region is
/// shorter.
template <typename T> constexpr T kLongestMove = T(Skin<T>::kDouble ? 8 : 4);

/// The few triangles near the proxy that are minded by their half-spaces rather than by casts.
template <typename T> class TouchPool {
public:
    static constexpr layout::uint kMost = 8;

    explicit TouchPool(const layout::MeshView<T>& mesh) noexcept : mesh_(mesh) {}

    layout::uint count() const noexcept { return count_; }
    Touch<T>& operator[](layout::uint i) noexcept { return touches_[i]; }
    const Touch<T>& operator[](layout::uint i) const noexcept { return touches_[i]; }
    /// The displacement found last, and the half-spaces active there.
    const Projection<T>& projection() const noexcept { return projection_; }
    Constraint constraint(layout::uint i) const noexcept { return constraints_[i]; }
    /// Shorter moves are none.
    T tolerance() const noexcept { return tolerance_; }
    /// The displacement found last ends before the point it is for.
    bool shortened() const noexcept { return shortened_; }

    void forget_all() noexcept { count_ = projection_.count = 0; }

    /// After moves: planes may be tried again.
    void allow_faces() noexcept {
        for (layout::uint i = 0; i < count_; ++i)
            touches_[i].face_tried = false;
    }

    /// Adds a candidate triangle; update_touches() computes its distance.
    void remember(layout::uint triangle) noexcept {
        if (knows(triangle) || (count_ == kMost && !forget_one()))
            return;
        put(triangle, count_);
        constraints_[count_++] = Constraint::none;
    }

    /// Minds a triangle in place of another.
    void put(layout::uint triangle, layout::uint place) noexcept {
        begin_touch(mesh_, triangle, touches_[place]);
        fetch_neighbours(mesh_, triangle);
    }

    bool knows(layout::uint triangle) const noexcept {
        for (layout::uint i = 0; i < count_; ++i)
            if (touches_[i].index == triangle)
                return true;
        return false;
    }

    void update_touches(const Vector<T>& proxy) noexcept {
        layout::uint kept = 0;
        for (layout::uint i = 0; i < count_; ++i) {
            if (kept != i)
                touches_[kept] = touches_[i];
            update_touch(touches_[kept], proxy);
            kept += touches_[kept].distance <= Skin<T>::kNear ? 1 : 0;
        }
        count_ = kept;
    }

    /// The displacement to the point nearest to the probe that the touched triangles allow. False, and no displacement,
    /// if rounding leaves none.
    [[nodiscard]] bool find_displacement(const Vector<T>& proxy, const Vector<T>& probe) noexcept {
        const Vector<T> wish = probe - proxy;
        const T length = largest_coordinate(wish);
        shortened_ = false;
        if (length > kLongestMove<T>)
            return find_long_displacement(proxy, probe);
        tolerance_ = Skin<T>::kRest + T(8) * std::numeric_limits<T>::epsilon() * length;
        if (count_ == 1 && touches_[0].above_face()) {
            find_displacement_on_face(wish);
            return true;
        }
        for (const bool relaxed : {false, true})
            if (project(wish, one_tolerance(tolerance_), projection_,
                        [&](const Vector<T>& displacement, HalfSpace<T>& space) {
                            return worst(displacement, relaxed, tolerance_, space);
                        }))
                return true;
        projection_.vector = Vector<T>(T(0));
        return false;
    }

    /// Whether a move keeps to the half-space of a triangle in the pool, so that it cannot cross it. Rounding tilts the
    /// plane of a rounded edge or corner: unless it is active, so that the move ends a skin aside, a long move may
    /// keep to that plane and cross the triangle, so a cast decides.
    bool keeps_off(layout::uint triangle, const Vector<T>& displacement) const noexcept {
        for (layout::uint i = 0; i < count_; ++i) {
            if (touches_[i].index != triangle)
                continue;
            for (layout::uint j = 0; j < projection_.count; ++j)
                if (projection_.active[j].source == i)
                    return true;
            const Constraint constraint = constraint_of(touches_[i], displacement);
            if (constraint == Constraint::none ||
                (constraint == Constraint::rounded && !(largest_coordinate(displacement) <= Skin<T>::kWidth)))
                return false;
            const HalfSpace<T> space = half_space(touches_[i], constraint, i);
            return dot(space.normal, displacement) >= space.slack - tolerance_;
        }
        return false;
    }

    /// Whether a triangle is behind a plane that the move keeps a skin in front of.
    bool lies_below(const Triangle<T>& triangle) const noexcept {
        constexpr T kFlush = Skin<T>::kFlush;
        for (layout::uint j = 0; j < projection_.count; ++j) {
            const layout::uint source = projection_.active[j].source;
            if (constraints_[source] != Constraint::face)
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
            bool constrains = false;
            for (layout::uint j = 0; j < projection_.count; ++j)
                constrains = constrains || projection_.active[j].source == i;
            if (constrains)
                continue;
            for (layout::uint j = 0; j < projection_.count; ++j)
                projection_.active[j].source -= projection_.active[j].source > i ? 1 : 0;
            for (layout::uint j = i; j + 1 < count_; ++j) {
                touches_[j] = touches_[j + 1];
                constraints_[j] = constraints_[j + 1];
            }
            --count_;
            return true;
        }
        return false;
    }

    /// The worst violated half-space: those of faces below the proxy first, since the others depend on where it goes.
    bool worst(const Vector<T>& displacement, bool relaxed, T tolerance, HalfSpace<T>& result) noexcept {
        T most = tolerance;
        bool found = false;
        for (const bool faces : {true, false}) {
            for (layout::uint i = 0; i < count_; ++i) {
                if (touches_[i].above_face() != faces)
                    continue;
                const Constraint constraint = constraint_of(touches_[i], displacement);
                if (constraint == Constraint::none)
                    continue;
                HalfSpace<T> space = half_space(touches_[i], constraint, i);
                if (relaxed && space.slack > T(0))
                    space.slack = T(0);
                const T violation = space.slack - dot(space.normal, displacement);
                if (violation > most) {
                    most = violation;
                    result = space;
                    constraints_[i] = constraint;
                    found = true;
                }
            }
            if (found)
                return true;
        }
        return false;
    }

    /// The same for a probe far off, of whose displacement into the planes little may be left along them. Finds the
    /// point itself, so that what rounding makes of it stays the same wherever the proxy is.
    bool find_long_displacement(const Vector<T>& proxy, const Vector<T>& probe) noexcept {
        constexpr T kRounding = T(8) * std::numeric_limits<T>::epsilon();
        const T push = Skin<T>::kRest + kRounding * largest_coordinate(probe);
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
        const T length = largest_coordinate(projection_.vector);
        shortened_ = length > kLongestMove<T>;
        if (shortened_)
            projection_.vector = projection_.vector * (kLongestMove<T> / length);
        tolerance_ = Skin<T>::kRest + kRounding * (shortened_ ? kLongestMove<T> : T(1) + length);
        return found;
    }

    /// The same for one face alone, the most common case.
    void find_displacement_on_face(const Vector<T>& wish) noexcept {
        const Vector<T>& normal = touches_[0].face;
        const T slack = Skin<T>::kWidth - touches_[0].height;
        const T multiplier = slack - dot(normal, wish);
        constraints_[0] = Constraint::face;
        projection_.count = multiplier > tolerance_ ? 1 : 0;
        projection_.vector = wish;
        if (projection_.count == 0)
            return;
        const Vector<T> displacement = wish + multiplier * normal;
        projection_.vector = displacement + (slack - dot(normal, displacement)) * normal;
        projection_.multipliers[0] = multiplier;
        projection_.active[0].normal = normal;
        projection_.active[0].slack = slack;
        projection_.active[0].source = 0;
    }

    const layout::MeshView<T>& mesh_;
    Touch<T> touches_[kMost];
    Constraint constraints_[kMost];
    layout::uint count_ = 0;
    Projection<T> projection_;
    T tolerance_{};
    bool shortened_ = false;
};

/// Sees every straight piece of a proxy's walk; this one ignores them.
struct NoTrace {
    template <typename T> void operator()(const Vector<T>&, const Vector<T>&) const noexcept {}
};

/// How far a step from a corner goes, to be clear of what the skin makes of it.
template <typename T> constexpr T kStride = Skin<T>::kWidth* T(32);

/// One update's walk. Every move keeps to the half-spaces of the triangles in the pool and is cast against all others.
template <typename T, typename Trace = NoTrace> class Walk {
public:
    static constexpr unsigned kSubsteps = 20000;
    static constexpr unsigned kPatience = 16;
    static constexpr layout::uint kBatch = 64;
    static constexpr layout::uint kFew = 12; /* tested one by one */
    static constexpr layout::uint kNone = ~0U;

    Walk(const layout::MeshView<T>& mesh, Neighbourhood<T>& neighbourhood, const Vector<T>& proxy,
         const Vector<T>& probe, const Trace& trace) noexcept
        : mesh_(mesh), neighbourhood_(neighbourhood), proxy_(proxy), probe_(probe), trace_(trace), pool_(mesh) {}

    const Vector<T>& proxy() const noexcept { return proxy_; }
    const Projection<T>& resting() const noexcept { return pool_.projection(); }
    const Touch<T>& touch(layout::uint i) const noexcept { return pool_[i]; }
    unsigned substeps() const noexcept { return substeps_; }
    bool finished() const noexcept { return substeps_ < kSubsteps; }

    void remember(layout::uint triangle) noexcept { pool_.remember(triangle); }

    /// Whether the walk was halted where a line between two faces ended.
    bool at_corner() const noexcept { return corner_; }

    /// Walks until the projection is zero, or to the end of a line between two faces, or until it has no solution.
    void run() noexcept {
        corner_ = false;
        rests_ = largest_coordinate(proxy_) > T(kRegion) && !enter();
        if (rests_)
            return;
        Vector<T> before = proxy_;
        unsigned until = substeps_;
        while (substeps_ < kSubsteps) {
            rests_ = substep();
            if (rests_ || !solved_)
                return;
            ++substeps_;
            if (corner_)
                return;
            if (substeps_ < until + kPatience)
                continue;
            // Rounding may make it tread on the spot between rounded edges: that is rest as well.
            if (is_stuck_since(before))
                return;
            before = proxy_;
            until = substeps_;
        }
    }

    /// Whether what constrained the proxy last still does: not if the walk was halted, trod on the spot, or found no
    /// displacement.
    bool rests() const noexcept { return rests_; }

    /// A probe far off is as far from everywhere: what is gained would not show.
    bool is_stuck_since(const Vector<T>& place) const noexcept {
        if (largest_coordinate(Vector<T>(probe_ - proxy_)) > kLongestMove<T>)
            return largest_coordinate(Vector<T>(proxy_ - place)) <= Skin<T>::kWidth * T(4);
        return !(gain_since(place) > Skin<T>::kWidth * T(0.0625));
    }

    /// By how much closer to the probe the proxy is than that place. Of a probe far off, what counts is the
    /// displacement.
    T gain_since(const Vector<T>& place) const noexcept {
        const Vector<T> both = (probe_ - place) + (probe_ - proxy_);
        const T length = std::sqrt(dot(both, both));
        return dot(proxy_ - place, both) / (length < T(2) * kLongestMove<T> ? length : T(2) * kLongestMove<T>);
    }

    bool above_constraining_face(layout::uint i) const noexcept {
        return pool_[resting().active[i].source].above_face();
    }

    /// Moves there unless something stands between.
    bool jump(const Vector<T>& there) noexcept {
        pool_.forget_all();
        Move<T> move{proxy_, there - proxy_, T(1)};
        if (cast(move).time <= T(1))
            return false;
        go_to(there);
        return true;
    }

    /// Walks towards a place as if the probe were there. Whether it gets there, but for its skin.
    bool walk_to(const Vector<T>& there) noexcept {
        const Vector<T> probe = probe_;
        probe_ = there;
        run();
        probe_ = probe;
        pool_.forget_all();
        const Vector<T> off = there - proxy_;
        return dot(off, off) <= Skin<T>::kCorner * Skin<T>::kCorner;
    }

    /// Begins anew from a rest.
    template <typename Rest> void restore(const Rest& rest) noexcept {
        proxy_ = rest.proxy;
        rests_ = corner_ = false;
        pool_.forget_all();
        for (layout::uint i = 0; i < rest.count; ++i)
            remember(rest.triangles[i]);
    }

private:
    struct Impact {
        T time;
        layout::uint triangle;
    };

    void go_to(const Vector<T>& place) noexcept {
        trace_(proxy_, place);
        proxy_ = place;
    }

    /// Far out no triangle is in the way: flies straight to the region, or to the probe if the line does not cross it.
    bool enter() noexcept {
        Vector<T> place;
        const bool enters = find_entry(proxy_, probe_, place);
        go_to(enters ? place : probe_);
        return enters;
    }

    /// The triangles that the move may meet, if it slides over the front of a triangle for which they are known: those
    /// known at its place. Only saves time.
    bool find_obstacles(std::span<const layout::uint>& obstacles) const noexcept {
        if (mesh_.obstacle_begins.empty() || resting().count != 1)
            return false;
        const layout::uint source = resting().active[0].source;
        const Touch<T>& touch = pool_[source];
        if (pool_.constraint(source) != Constraint::face || !touch.above_face() || touch.face != touch.triangle.normal)
            return false;
        const layout::uint begin = mesh_.obstacle_begins[touch.index], end = mesh_.obstacle_begins[touch.index + 1];
        obstacles = mesh_.obstacles.subspan(begin, end - begin);
        return obstacles.empty() || obstacles[0] != layout::kMeshAnyObstacle;
    }

    /// The first impact of a move, which is cut there. Triangles are sifted in batches without a branch each, so that
    /// one does not wait for the memory of another.
    Impact cast(Move<T>& move) noexcept {
        Impact first{T(2), 0};
        layout::uint batch[kBatch];
        layout::uint count = 0;
        std::span<const layout::uint> obstacles;
        if (find_obstacles(obstacles)) {
            std::copy(obstacles.begin(), obstacles.end(), batch);
            cast_at(batch, static_cast<layout::uint>(obstacles.size()), move, first);
            return first;
        }
        static_assert(kBatch >= CloseTriangles<T>::kMost);
        if (update_close(mesh_, neighbourhood_, move)) {
            hit_first(batch, sift(neighbourhood_.close, move, batch), move, first);
            return first;
        }
        visit_runs_near(mesh_, neighbourhood_, move, [&](layout::uint triangle, layout::uint end) {
            while (triangle < end)
                batch[count++] = triangle++;
            if (count > kBatch - layout::kMeshLeafTriangles) {
                cast_at(batch, count, move, first);
                count = 0;
            }
        });
        cast_at(batch, count, move, first);
        return first;
    }

    void cast_at(layout::uint* batch, layout::uint count, Move<T>& move, Impact& first) const noexcept {
        constexpr T kFar = Skin<T>::kCulled;
        layout::uint left = 0;
        for (layout::uint i = 0; i < count; ++i) {
            const std::size_t triangle = batch[i];
            const std::size_t corner = 3 * std::size_t(mesh_.triangle_corners[3 * triangle]);
            const Vector<T> normal = vector_at(mesh_.triangle_normals, triangle);
            const Vector<T> to{move.from.x - mesh_.vertices[corner], move.from.y - mesh_.vertices[corner + 1],
                               move.from.z - mesh_.vertices[corner + 2]};
            const T begin = dot(normal, to), end = begin + move.until * dot(normal, move.displacement);
            const bool apart = ((begin > kFar) & (end > kFar)) | ((begin < -kFar) & (end < -kFar));
            batch[left] = static_cast<layout::uint>(triangle);
            left += apart ? 0 : 1;
        }
        if (left > kFew)
            left = sift_by_edges(batch, left, move);
        hit_first(batch, left, move, first);
    }

    /// Where many triangles meet, a move comes near all their planes, but misses most of them.
    layout::uint sift_by_edges(layout::uint* batch, layout::uint count, const Move<T>& move) const noexcept {
        layout::uint left = 0;
        for (layout::uint i = 0; i < count; i += kLanes<T>) {
            const auto beyond = beyond_an_edge(
                triangle_lanes(mesh_, [&](layout::uint lane) { return batch[std::min(i + lane, count - 1)]; }), move);
            for (layout::uint lane = 0; lane < std::min(kLanes<T>, count - i); ++lane) {
                batch[left] = batch[i + lane];
                left += beyond[lane] != 0 ? 0 : 1;
            }
        }
        return left;
    }

    /// The first impact with one of a few triangles, if it comes before what was found so far.
    void hit_first(const layout::uint* batch, layout::uint left, Move<T>& move, Impact& first) const noexcept {
        for (layout::uint i = 0; i < left; ++i) {
            if (pool_.keeps_off(batch[i], move.displacement))
                continue;
            const Triangle<T> triangle = triangle_at(mesh_, batch[i]);
            if (is_off_plane(triangle, move) || pool_.lies_below(triangle))
                continue;
            const T time = impact_time(triangle, move);
            if (time > move.until || (time == first.time && !comes_before(mesh_, batch[i], first.triangle)))
                continue;
            first = {time, batch[i]};
            move.until = time;
        }
    }

    /// True when at rest.
    bool substep() noexcept {
        pool_.update_touches(proxy_);
        solved_ = pool_.find_displacement(proxy_, probe_);
        if (!solved_)
            return false;
        if constexpr (requires { trace_.sees(pool_); })
            trace_.sees(pool_);
        const Vector<T>& displacement = resting().vector;
        if (largest_coordinate(displacement) <= pool_.tolerance() && resting().count > 0)
            return true;
        Move<T> move{proxy_, displacement, T(1)};
        Release<T> release{T(1), 3};
        layout::uint released = kNone;
        for (layout::uint i = 0; i < resting().count; ++i) {
            const layout::uint source = resting().active[i].source;
            const Release<T> one = pool_.constraint(source) == Constraint::face
                                       ? release_of_face(pool_[source], displacement, release.time)
                                       : release_of_rounded(pool_[source], displacement, release.time);
            if (one.time < release.time) {
                release = one;
                released = source;
            }
        }
        move.until = release.time;
        return finish(move, release, released);
    }

    bool finish(Move<T>& move, const Release<T>& release, layout::uint released) noexcept {
        const Impact impact = clipped_cast(move);
        const bool hit = impact.time <= release.time;
        const T time = hit ? impact.time : release.time;
        const T length = time * largest_coordinate(move.displacement);
        const bool moves = length > Skin<T>::kRest;
        corner_ = (hit || released != kNone) && resting().count == 2 && length > kStride<T>;
        if (moves)
            pool_.allow_faces();
        if (hit) {
            go_to(move.at(time));
            remember(impact.triangle);
            return false;
        }
        if (released != kNone) {
            pool_[released].face_tried = !moves;
            go_to(move.at(time));
            hand_over(released, release.edge);
            return false;
        }
        // No triangle is hit: without a plane to keep to, that is the probe itself.
        go_to(resting().count == 0 ? probe_ : move.at(T(1)));
        const bool one_face = pool_.count() == 1 && resting().count == 1 && pool_[0].above_face();
        return resting().count == 0 ||
               (one_face && !pool_.shortened() && stays_above_face(pool_[0], move.displacement));
    }

    /// A move that leaves the region ends in the open.
    Impact clipped_cast(Move<T>& move) noexcept {
        const T reach = largest_coordinate(move.at(move.until));
        if (reach > T(kRegion)) {
            T until = move.until;
            for (int i = 0; i < 3; ++i) {
                const T edge = move.displacement[i] < T(0) ? -T(kRegion) : T(kRegion);
                if (std::abs(move.from[i] + move.until * move.displacement[i]) > T(kRegion))
                    until = std::min(until, (edge - move.from[i]) / move.displacement[i]);
            }
            move.until = until > T(0) ? until : T(0);
        }
        return cast(move);
    }

    /// The triangle across the edge comes next, most likely: known already, it need not be hit first. If all of the one
    /// that was left lies below its plane, that one constrains no longer.
    void hand_over(layout::uint released, layout::uint edge) noexcept {
        if (edge > 2)
            return;
        const layout::uint across = mesh_.triangle_neighbours[3 * std::size_t(pool_[released].index) + edge];
        if (across == layout::kMeshBorder || (across & layout::kMeshManyBit) != 0)
            return;
        const Vector<T> normal = vector_at(mesh_.triangle_normals, across);
        const Vector<T> corner = vector_at(mesh_.vertices, mesh_.triangle_corners[3 * std::size_t(across)]);
        const T height = dot(normal, proxy_ - corner);
        const T apex = dot(normal, pool_[released].triangle.corners[(edge + 2) % 3] - corner);
        if (!(height * apex > T(0)) && !pool_.knows(across))
            pool_.put(across, released);
        else
            remember(across);
    }

    const layout::MeshView<T>& mesh_;
    Neighbourhood<T>& neighbourhood_;
    Vector<T> proxy_, probe_;
    const Trace& trace_;
    TouchPool<T> pool_;
    unsigned substeps_ = 0;
    bool corner_ = false;
    bool solved_ = true;
    bool rests_ = false;
};

} // namespace forceshade::reference
