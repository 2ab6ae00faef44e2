#include "host/mesh/region_sweep.h"

#include <algorithm>

#include "host/mesh/beam.h"
#include "host/reference/elementary.h"
#include "host/reference/mesh_nearest.h"

namespace forceshade {

namespace {

using layout::uint;
using reference::cross;
using reference::dot;
using Real3 = reference::Vector<float>;
using glm::dvec3;

constexpr double kWidestArc = 0.5;   // the widest arc of directions, as a chord
constexpr double kSlantedAxis = 0.4; // of the fastest axis's speed, that of the axis along which a wedge is swept

double length(const dvec3& v) {
    return std::sqrt(dot(v, v));
}

double largest_of(const dvec3& v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

// Sweeps the region of each feature on the inner side.
class RegionSweep {
public:
    RegionSweep(const SweepInput& input, SweepOutput& output) : input_(input), output_(output), beams_(input) {
        const dvec3& spacing = beams_.spacing();
        widest_ = std::max({spacing.x, spacing.y, spacing.z});
        reach_ = static_cast<float>(input.margin * std::min({spacing.x, spacing.y, spacing.z}));
        // Beyond 200 times the slack, this much of the square is more than the slack.
        quick_ = 401 * input.slack.base * input.slack.base;
        deepest_ = static_cast<double>(input.surface.deepest);
        const SweptGrid& grid = input.grid;
        low_z_ = static_cast<double>(grid.at[2][std::size_t(grid.z_first)]) - spacing.z;
        high_z_ = static_cast<double>(grid.at[2][std::size_t(grid.z_end - 1)]) + spacing.z;
    }

    void triangle(std::size_t index) {
        const SweptSurface& surface = input_.surface;
        std::array<dvec3, 3> corners;
        for (std::size_t i = 0; i < 3; ++i)
            corners[i] = surface.vertex(surface.corners[3 * index + i]);
        const auto [low, high] = std::minmax({corners[0].z, corners[1].z, corners[2].z});
        if (!reaches(low - deepest_, high + deepest_))
            return;
        const double along = -surface.normal(index).z * deepest_;
        if (reaches(std::min(low, low + along), std::max(high, high + along)))
            face(index, corners);
        for (std::size_t i = 0; i < 3; ++i)
            edge(index, i, corners);
    }

    void vertex(std::size_t index) {
        const SweptSurface& surface = input_.surface;
        const std::size_t begin = surface.star_begins[index], end = surface.star_begins[index + 1];
        if (begin == end)
            return;
        const dvec3 tip = surface.vertex(index);
        if (!reaches(tip.z - deepest_, tip.z + deepest_))
            return;
        bool has_reflex = false;
        edges_.clear();
        for (std::size_t i = begin; i < end; ++i) {
            const std::size_t corner = surface.stars[i], triangle = corner / 3;
            const std::size_t next = corner % 3 == 2 ? corner - 2 : corner + 1;
            const dvec3 along = surface.vertex(surface.corners[next]) - tip;
            has_reflex = has_reflex || is_reflex(triangle, surface.neighbours[corner], along);
            if (const double size = length(along); size > 0)
                edges_.push_back(along / size);
        }
        if (!has_reflex)
            return;
        const dvec3 outward(reference::vector_at(std::span<const float>(surface.pseudonormals), index));
        if (const double size = length(outward); size > 0)
            edges_.push_back(outward / size);
        const SweptCorner corner{Real3(tip), static_cast<uint>(surface.stars[begin] / 3)};
        for (int axis = 0; axis < 3; ++axis)
            for (const int sign : {1, -1})
                cone(corner, tip, axis, sign);
    }

private:
    // Whether what has these ends along z may come to the samples.
    bool reaches(double low, double high) const { return low <= high_z_ && high >= low_z_; }

    // In samples.
    dvec3 speed_of(const dvec3& direction) const {
        const dvec3& spacing = beams_.spacing();
        return {direction.x / spacing.x, direction.y / spacing.y, direction.z / spacing.z};
    }

    // Whether there is room on the inner side for what is nearest to an edge: as far as no margin of the faces covers.
    bool is_reflex(std::size_t triangle, std::size_t other, const dvec3& along) const {
        const dvec3 normal = input_.surface.normal(triangle), across = input_.surface.normal(other);
        return dot(cross(normal, across), along) < -1e-2 * double(reach_) * length(along);
    }

    void offer(std::size_t cell, float square, uint triangle) {
        const std::atomic_ref<std::uint64_t> shared(input_.cells[cell]);
        std::uint64_t known = shared.load(std::memory_order_relaxed);
        const std::uint64_t mine = cell_of(square, triangle);
        const auto tie = [&](uint other, float its) {
            output_.ties.push_back({static_cast<std::uint32_t>(cell), other, its});
        };
        while (mine < known)
            if (shared.compare_exchange_weak(known, mine, std::memory_order_relaxed)) {
                const uint other = triangle_of(known);
                if (other != kNoTriangle && other != triangle && square_of(known) <= input_.slack.limit(square))
                    tie(other, square_of(known));
                return;
            }
        if (triangle_of(known) != triangle && square <= input_.slack.limit(square_of(known)))
            tie(triangle, square);
    }

    // Of measured samples those whose nearest triangle may be this one; whether there are some.
    template <typename Offer> bool offer_run(const SampleRun& run, const Offer& offer_one) {
        std::size_t count = 0;
        for (std::size_t i = 0; i < run.count; ++i) {
            passed_[count] = static_cast<std::uint8_t>(i);
            count += run.square[i] <= run.known[i] * 1.01f + quick_ && run.beyond[i] <= reach_ ? 1 : 0;
        }
        for (std::size_t i = 0; i < count; ++i)
            offer_one(passed_[i]);
        return std::any_of(passed_.begin(), passed_.begin() + std::ptrdiff_t(count),
                           [&](std::size_t i) { return run.square[i] <= run.known[i]; });
    }

    void face(std::size_t index, const std::array<dvec3, 3>& corners) {
        const dvec3 normal = input_.surface.normal(index);
        SweptFace face{
            {{Real3(corners[0]), Real3(corners[1]), Real3(corners[2])}, Real3(normal)}, {}, static_cast<uint>(index)};
        for (std::size_t i = 0; i < 3; ++i) {
            const dvec3 side = cross(dvec3(corners[(i + 1) % 3] - corners[i]), normal);
            face.sides[i] = Real3(side / length(side));
        }
        int axis = 0;
        const dvec3 speed = speed_of(normal);
        for (int i = 1; i < 3; ++i)
            axis = std::abs(speed[i]) > std::abs(speed[axis]) ? i : axis;
        const dvec3 step = beams_.step_of(-normal, axis);
        beams_.sweep(Beam<3>{corners, {step, step, step}}, {axis, step[axis] > 0}, face, [&](const SampleRun& run) {
            return offer_run(run, [&](std::size_t i) { offer_face(face, run, i); });
        });
    }

    void offer_face(const SweptFace& face, const SampleRun& run, std::size_t i) {
        const float square =
            run.beyond[i] <= 0 ? run.square[i] : reference::nearest_on_triangle(run.at(i), face.triangle).square;
        if (run.known[i] > 0)
            offer(run.cells[i], square, face.index);
        else if (square <= static_cast<float>(input_.near * input_.near))
            output_.outside.push_back({run.cells[i], face.index, square});
    }

    void edge(std::size_t index, std::size_t i, const std::array<dvec3, 3>& corners) {
        const std::size_t other = input_.surface.neighbours[3 * index + i];
        const dvec3 &a = corners[i], &b = corners[(i + 1) % 3], along = b - a;
        if (other < index || !is_reflex(index, other, along))
            return;
        const SweptEdge edge{Real3(a), Real3(along), static_cast<float>(1 / dot(along, along)),
                             static_cast<uint>(index)};
        wedge(edge, a, b, -input_.surface.normal(index), -input_.surface.normal(other), 0);
    }

    // All that lies inwards of an edge between two directions.
    void wedge(const SweptEdge& edge, const dvec3& a, const dvec3& b, const dvec3& from, const dvec3& to, int depth) {
        const dvec3 one = speed_of(from), other = speed_of(to);
        int axis = -1;
        double best = 0;
        for (int i = 0; i < 3; ++i)
            if (one[i] * other[i] > 0) {
                const double slant =
                    std::min(std::abs(one[i]) / largest_of(one), std::abs(other[i]) / largest_of(other));
                if (slant > best) {
                    best = slant;
                    axis = i;
                }
            }
        constexpr int kDeepest = 12;
        if (depth < kDeepest && (best < kSlantedAxis || length(from - to) > kWidestArc)) {
            const dvec3 middle = from + to, half = middle / length(middle);
            wedge(edge, a, b, from, half, depth + 1);
            wedge(edge, a, b, half, to, depth + 1);
            return;
        }
        if (axis < 0)
            return;
        const dvec3 first = beams_.step_of(from, axis), second = beams_.step_of(to, axis);
        beams_.sweep(Beam<4>{{a, b, a, b}, {first, first, second, second}}, {axis, from[axis] > 0}, edge,
                     [&](const SampleRun& run) { return offer_all(run, edge.index); });
    }

    bool offer_all(const SampleRun& run, uint triangle) {
        return offer_run(run, [&](std::size_t i) {
            if (run.known[i] > 0)
                offer(run.cells[i], run.square[i], triangle);
        });
    }

    struct Corner2 {
        double u, v;
    };

    // The part of a corner's cone that is steepest along one axis: no edge goes nearer from it.
    void cone(const SweptCorner& corner, const dvec3& tip, int axis, int sign) {
        const BeamCourse course{axis, sign > 0};
        const auto [u, v] = course.across();
        const dvec3& spacing = beams_.spacing();
        constexpr double kLoose = 1e-4; // of a sine
        section_.assign({{-1, -1}, {1, -1}, {1, 1}, {-1, 1}});
        for (const dvec3& edge : edges_) {
            clip(edge[u] * spacing[u], edge[v] * spacing[v], edge[axis] * spacing[axis] * sign - kLoose * widest_);
            if (section_.empty())
                return;
        }
        double u0 = 1, u1 = -1, v0 = 1, v1 = -1;
        for (const Corner2& at : section_) {
            u0 = std::min(u0, at.u);
            u1 = std::max(u1, at.u);
            v0 = std::min(v0, at.v);
            v1 = std::max(v1, at.v);
        }
        Beam<4> beam;
        for (std::size_t k = 0; k < 4; ++k) {
            dvec3& step = beam.steps[k];
            step[u] = (k % 2 == 0 ? u0 : u1) * spacing[u];
            step[v] = (k < 2 ? v0 : v1) * spacing[v];
            step[axis] = sign * spacing[axis];
            beam.corners[k] = tip;
        }
        beams_.sweep(beam, course, corner, [&](const SampleRun& run) { return offer_all(run, corner.index); });
    }

    // What of the section has by_u u + by_v v + constant <= 0.
    void clip(double by_u, double by_v, double constant) {
        clipped_.clear();
        for (std::size_t i = 0; i < section_.size(); ++i) {
            const Corner2 &one = section_[i], &next = section_[i + 1 == section_.size() ? 0 : i + 1];
            const double at_one = by_u * one.u + by_v * one.v + constant,
                         at_next = by_u * next.u + by_v * next.v + constant;
            if (at_one <= 0)
                clipped_.push_back(one);
            if ((at_one <= 0) != (at_next <= 0)) {
                const double share = at_one / (at_one - at_next);
                clipped_.push_back({one.u + share * (next.u - one.u), one.v + share * (next.v - one.v)});
            }
        }
        std::swap(section_, clipped_);
    }

    const SweepInput& input_;
    SweepOutput& output_;
    BeamSweep beams_;
    double widest_, deepest_, low_z_, high_z_;
    float reach_; // 1: how far beyond its edges a face counts
    float quick_;
    std::vector<dvec3> edges_;
    std::vector<Corner2> section_, clipped_;
    std::array<std::uint8_t, SampleRun::kMost> passed_;
};

} // namespace

NearVertices::NearVertices(const SweptSurface& surface, const SweptGrid& grid) {
    constexpr std::size_t kMostBricks = std::size_t(1) << 18;
    const auto count = [&] {
        std::size_t all = 1;
        for (std::size_t axis = 0; axis < 3; ++axis)
            all *= bricks_[axis] = ((grid.at[axis].size() - 1) >> shift_) + 1;
        return all;
    };
    while (count() > kMostBricks)
        ++shift_;
    const std::size_t all = count();
    std::array<std::vector<float>, 3> middles;
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (std::size_t i = 0; i < bricks_[axis]; ++i) {
            const std::size_t first = i << shift_, last = std::min(grid.at[axis].size(), (i + 1) << shift_) - 1;
            middles[axis].push_back((grid.at[axis][first] + grid.at[axis][last]) / 2);
        }
    vertices_.assign(3 * all, 0);
    std::vector<float> squares(all, std::numeric_limits<float>::infinity());
    const auto brick_at = [&](std::size_t x, std::size_t y, std::size_t z) {
        return (z * bricks_[1] + y) * bricks_[0] + x;
    };
    const auto take = [&](std::size_t x, std::size_t y, std::size_t z, const float* vertex) {
        const float dx = vertex[0] - middles[0][x], dy = vertex[1] - middles[1][y], dz = vertex[2] - middles[2][z];
        const float square = dx * dx + dy * dy + dz * dz;
        const std::size_t brick = brick_at(x, y, z);
        if (square < squares[brick]) {
            squares[brick] = square;
            std::copy_n(vertex, 3, &vertices_[3 * brick]);
        }
    };
    for (std::size_t vertex = 0; vertex < surface.count_vertices(); ++vertex) {
        std::array<std::size_t, 3> at;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double sample =
                (double(surface.vertices[3 * vertex + axis]) - grid.origin[axis]) / grid.spacing[axis];
            const double last = double(bricks_[axis] - 1);
            at[axis] = static_cast<std::size_t>(std::clamp(std::floor(sample / double(1 << shift_)), 0.0, last));
        }
        take(at[0], at[1], at[2], &surface.vertices[3 * vertex]);
    }
    // From neighbour to neighbour, forwards and backwards.
    const auto relax = [&](std::size_t x, std::size_t y, std::size_t z, int sign) {
        for (int dz = -1; dz <= 0; ++dz)
            for (int dy = -1; dy <= (dz < 0 ? 1 : 0); ++dy)
                for (int dx = -1; dx <= (dz < 0 || dy < 0 ? 1 : -1); ++dx) {
                    const std::size_t i = x + std::size_t(sign * dx), j = y + std::size_t(sign * dy),
                                      k = z + std::size_t(sign * dz);
                    if (i < bricks_[0] && j < bricks_[1] && k < bricks_[2])
                        if (const std::size_t other = brick_at(i, j, k);
                            squares[other] < std::numeric_limits<float>::infinity()) {
                            const std::array<float, 3> vertex{vertices_[3 * other], vertices_[3 * other + 1],
                                                              vertices_[3 * other + 2]};
                            take(x, y, z, vertex.data());
                        }
                }
    };
    for (std::size_t z = 0; z < bricks_[2]; ++z)
        for (std::size_t y = 0; y < bricks_[1]; ++y)
            for (std::size_t x = 0; x < bricks_[0]; ++x)
                relax(x, y, z, 1);
    for (std::size_t z = bricks_[2]; z-- > 0;)
        for (std::size_t y = bricks_[1]; y-- > 0;)
            for (std::size_t x = bricks_[0]; x-- > 0;)
                relax(x, y, z, -1);
}

void sweep_triangles(const SweepInput& input, std::size_t first, std::size_t end, SweepOutput& output) {
    RegionSweep sweeper(input, output);
    for (std::size_t triangle = first; triangle < end; ++triangle)
        sweeper.triangle(triangle);
}

void sweep_vertices(const SweepInput& input, std::size_t first, std::size_t end, SweepOutput& output) {
    RegionSweep sweeper(input, output);
    for (std::size_t vertex = first; vertex < end; ++vertex)
        sweeper.vertex(vertex);
}

} // namespace forceshade
