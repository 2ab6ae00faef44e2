// Which facets belong together: pieces, and facets that coincide.
#include "host/mesh/connectivity.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "host/error.h"
#include "host/mesh/places.h"
#include "host/numbers.h"
#include "host/reference/elementary.h"

namespace forceshade {

namespace {

using reference::cross, reference::dot;

constexpr std::size_t kMostSolidAngles = 100'000'000;

// Facets in sets, each the same way round as its set's least member or the other: every one is there twice, as it is
// and, `count` further on, turned; what agrees is joined.
class OrientedSets {
public:
    explicit OrientedSets(std::size_t count) : count_(static_cast<std::uint32_t>(count)), sets_(2 * count) {}

    /// The set's least member, and whether this one is turned against it.
    std::pair<std::uint32_t, bool> find(std::uint32_t member) {
        const std::uint32_t plain = sets_.find(member), turned = sets_.find(member + count_);
        return {std::min(plain, turned), turned < plain};
    }

    /// False if it is known otherwise.
    bool join(std::uint32_t one, std::uint32_t other, bool turned) {
        const std::uint32_t alike = other + (turned ? count_ : 0), opposite = other + (turned ? 0 : count_);
        if (sets_.find(one) == sets_.find(opposite))
            return false;
        sets_.join(one, alike);
        sets_.join(one + count_, opposite);
        return true;
    }

private:
    std::uint32_t count_;
    DisjointSets sets_;
};

class PieceFinder {
public:
    explicit PieceFinder(const PolygonSoup& polygons)
        : polygons_(polygons), sides_(polygons), sets_(polygons.facets()) {}

    MeshPieces run() {
        join();
        number();
        find_openings();
        measure();
        // Those that face inward first: of them more depends on it.
        for (const bool inward : {true, false})
            for (MeshPiece& piece : found_.pieces)
                if (piece.closed && piece.opposed == 0 && (piece.volume < 0) == inward)
                    piece.surrounding = surrounding(piece, inward ? kMostSolidAngles : kMostSolidAngles / 10);
        return std::move(found_);
    }

private:
    /// Calls use(sides) for the sides of facets along each edge that has two places.
    template <typename Use> void for_each_edge(const Use& use) const {
        sides_.for_each_edge([&](std::span<const std::uint32_t> sides) {
            if (sides_.start(sides[0]) != sides_.end(sides[0]))
                use(sides);
        });
    }

    void join() {
        for_each_edge([&](const auto& sides) {
            if (sides.size() != 2)
                return;
            const std::uint32_t one = sides_.facet(sides[0]), other = sides_.facet(sides[1]);
            if (!sets_.join(one, other, sides_.start(sides[0]) == sides_.start(sides[1])))
                contradictions_.push_back(one);
        });
    }

    void number() {
        found_.of_facet.resize(polygons_.facets());
        found_.opposed.resize(polygons_.facets());
        for (std::uint32_t facet = 0; facet < polygons_.facets(); ++facet) {
            const auto [root, flipped] = sets_.find(facet);
            found_.opposed[facet] = flipped;
            if (root == facet) {
                found_.of_facet[facet] = static_cast<std::uint32_t>(found_.pieces.size());
                found_.pieces.push_back({.first_facet = facet});
            } else {
                found_.of_facet[facet] = found_.of_facet[root];
            }
            ++found_.pieces[found_.of_facet[facet]].facets;
        }
        for (const std::uint32_t facet : contradictions_)
            found_.pieces[found_.of_facet[facet]].one_sided = true;
    }

    void find_openings() {
        std::vector<std::uint32_t> here;
        for_each_edge([&](const auto& sides) {
            here.clear();
            for (const std::uint32_t side : sides)
                here.push_back(found_.of_facet[sides_.facet(side)]);
            std::ranges::sort(here);
            for (auto first = here.begin(); first != here.end();) {
                const auto next = std::upper_bound(first, here.end(), *first);
                if ((next - first) % 2 == 1)
                    found_.pieces[*first].closed = false;
                first = next;
            }
        });
    }

    /// Calls use(a, b, c) for the triangles of a fan of the facet.
    template <typename Use> void for_each_triangle(std::uint32_t facet, const Use& use) const {
        const auto outline = polygons_.outline(facet);
        for (std::size_t i = 2; i < outline.size(); ++i)
            use(polygons_.vertices[outline[0]], polygons_.vertices[outline[i - 1]], polygons_.vertices[outline[i]]);
    }

    void measure() {
        std::vector<double> area(found_.pieces.size(), 0.0), opposed_area(area);
        boxes_.assign(found_.pieces.size(), {glm::dvec3(HUGE_VAL), glm::dvec3(-HUGE_VAL)});
        facets_of_.resize(found_.pieces.size());
        const MeshBox whole = bounding_box(polygons_);
        const glm::dvec3 middle = whole.low / 2.0 + whole.high / 2.0;
        for (std::uint32_t facet = 0; facet < polygons_.facets(); ++facet) {
            const std::uint32_t piece = found_.of_facet[facet];
            facets_of_[piece].push_back(facet);
            MeshBox& box = boxes_[piece];
            for (const std::uint32_t vertex : polygons_.outline(facet))
                box = {glm::min(box.low, polygons_.vertices[vertex]), glm::max(box.high, polygons_.vertices[vertex])};
            for_each_triangle(facet, [&](const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
                const glm::dvec3 normal = cross<double>(b - a, c - a);
                const double size = std::sqrt(dot(normal, normal)) / 2;
                area[piece] += size;
                opposed_area[piece] += found_.opposed[facet] ? size : 0;
                found_.pieces[piece].volume += dot<double>(a - middle, normal) / 6;
            });
        }
        for (std::uint32_t facet = 0; facet < polygons_.facets(); ++facet) {
            MeshPiece& piece = found_.pieces[found_.of_facet[facet]];
            if (opposed_area[found_.of_facet[facet]] > area[found_.of_facet[facet]] / 2)
                found_.opposed[facet].flip();
            piece.opposed += found_.opposed[facet];
        }
    }

    /// Of all closed pieces but this one, at the middle of its largest triangle.
    double surrounding(const MeshPiece& piece, std::size_t most_steps) {
        const std::uint32_t mine = found_.of_facet[piece.first_facet];
        glm::dvec3 place(0);
        double largest = -1;
        for (const std::uint32_t facet : facets_of_[mine])
            for_each_triangle(facet, [&](const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
                const glm::dvec3 normal = cross<double>(b - a, c - a);
                if (dot(normal, normal) > largest)
                    largest = dot(normal, normal), place = a + (b - a) / 3.0 + (c - a) / 3.0;
            });
        double angle = 0;
        for (std::uint32_t other = 0; other < found_.pieces.size(); ++other) {
            const MeshBox& box = boxes_[other];
            if (other == mine || !found_.pieces[other].closed || steps_ > most_steps || place.x < box.low.x ||
                place.y < box.low.y || place.z < box.low.z || place.x > box.high.x || place.y > box.high.y ||
                place.z > box.high.z)
                continue;
            for (const std::uint32_t facet : facets_of_[other])
                for_each_triangle(facet, [&](const glm::dvec3& one, const glm::dvec3& two, const glm::dvec3& three) {
                    // Van Oosterom & Strackee (1983).
                    const glm::dvec3 a = one - place, b = two - place, c = three - place;
                    const double p = std::sqrt(dot(a, a)), q = std::sqrt(dot(b, b)), r = std::sqrt(dot(c, c));
                    angle +=
                        2 * std::atan2(dot(a, cross(b, c)), p * q * r + dot(a, b) * r + dot(b, c) * p + dot(c, a) * q);
                    ++steps_;
                });
        }
        return angle / (4 * M_PI);
    }

    const PolygonSoup& polygons_;
    FacetSides sides_;
    OrientedSets sets_;
    std::vector<std::uint32_t> contradictions_; // facets
    MeshPieces found_;
    std::vector<MeshBox> boxes_;
    std::vector<std::vector<std::uint32_t>> facets_of_; // of each piece
    std::size_t steps_ = 0;
};

void turn(PolygonSoup& polygons, std::uint32_t facet) {
    const auto first = polygons.begins[facet], last = polygons.begins[facet + 1];
    std::reverse(polygons.corners.begin() + first, polygons.corners.begin() + last);
    if (!polygons.normals.empty())
        std::reverse(polygons.normals.begin() + first, polygons.normals.begin() + last);
}

} // namespace

MeshPieces find_pieces(const PolygonSoup& polygons) {
    return PieceFinder(polygons).run();
}

std::string name_of(std::size_t piece, const MeshPieces& found) {
    if (found.pieces.size() == 1)
        return "the mesh";
    const MeshPiece& one = found.pieces[piece];
    return fmt::format("piece {} of {} ({}, from facet {} on)", piece + 1, found.pieces.size(),
                       numbers::counted(one.facets, "facet"), one.first_facet);
}

std::vector<std::string> orient_outward(PolygonSoup& polygons) {
    std::vector<std::string> turned;
    MeshPieces found = find_pieces(polygons);
    for (std::size_t i = 0; i < found.pieces.size(); ++i) {
        if (found.pieces[i].one_sided)
            throw UsageError("orient = \"outward\": {} has one side only, as a Moebius strip has, and so "
                             "no outside; leave orient out, or cut the mesh there",
                             name_of(i, found));
        if (found.pieces[i].opposed > 0)
            turned.push_back(fmt::format("turned {} of {}, which faced against the others",
                                         numbers::counted(found.pieces[i].opposed, "facet"), name_of(i, found)));
    }
    for (std::uint32_t facet = 0; facet < polygons.facets(); ++facet)
        if (found.opposed[facet])
            turn(polygons, facet);
    // Outer pieces first: whether an inner one is a cavity depends on them.
    for (bool goes_on = true; goes_on;) {
        goes_on = false;
        found = find_pieces(polygons);
        std::vector<bool> turns(found.pieces.size());
        for (std::size_t i = 0; i < turns.size(); ++i) {
            const MeshPiece& piece = found.pieces[i];
            const bool outer = piece.is_inside_out() && piece.surrounding > -0.25;
            const bool cavity = piece.closed && piece.volume > 0 && piece.surrounding < -0.75;
            if (!outer && !cavity)
                continue;
            turns[i] = goes_on = true;
            turned.push_back(fmt::format("turned {}, {}", name_of(i, found),
                                         outer ? "which faced inward" : "a cavity of what faced inward"));
        }
        for (std::uint32_t facet = 0; facet < polygons.facets(); ++facet)
            if (turns[found.of_facet[facet]])
                turn(polygons, facet);
    }
    return turned;
}

namespace {

struct Pair {
    std::uint32_t facets[2];
    bool open = true; // no stray found
};

class CoincidentSearch {
public:
    CoincidentSearch(const PolygonSoup& polygons, std::span<const glm::dvec3> normals)
        : polygons_(polygons), normals_(normals), places_(weld(polygons)) {}

    CoincidentFacets run() {
        match();
        if (!pairs_.empty())
            find_strays();
        std::ranges::sort(found_.redundant);
        found_.opposed = static_cast<std::size_t>(std::ranges::count(pairs_, true, &Pair::open));
        return std::move(found_);
    }

private:
    void match() {
        // Each facet's corners by place, from the lowest one on towards the lower of its two neighbours.
        std::vector<std::uint32_t> corners(polygons_.corners.size());
        std::ranges::transform(polygons_.corners, corners.begin(),
                               [&](std::uint32_t corner) { return places_[corner]; });
        const auto cycle = [&](std::size_t facet) {
            return std::span(corners).subspan(polygons_.begins[facet], polygons_.corners_of(facet));
        };
        std::vector<bool> backwards(polygons_.facets());
        std::vector<std::uint32_t> begins(places_.size() + 2, 0); // of the facets with a lowest place
        for (std::uint32_t facet = 0; facet < polygons_.facets(); ++facet) {
            const auto mine = cycle(facet);
            if (mine.empty())
                continue;
            std::rotate(mine.begin(), std::ranges::min_element(mine), mine.end());
            backwards[facet] = mine.back() < mine[1 % mine.size()];
            if (backwards[facet])
                std::reverse(mine.begin() + 1, mine.end());
            ++begins[mine.front() + 2];
        }
        std::partial_sum(begins.begin(), begins.end(), begins.begin());
        std::vector<std::uint32_t> filed(begins.back());
        for (std::uint32_t facet = 0; facet < polygons_.facets(); ++facet)
            if (const auto mine = cycle(facet); !mine.empty())
                filed[begins[mine.front() + 1]++] = facet;
        for (std::size_t place = 0; place < places_.size(); ++place) {
            const auto here = std::span(filed).subspan(begins[place], begins[place + 1] - begins[place]);
            std::ranges::sort(here, [&](std::uint32_t one, std::uint32_t other) {
                const auto mine = cycle(one), its = cycle(other);
                const auto order =
                    std::lexicographical_compare_three_way(mine.begin(), mine.end(), its.begin(), its.end());
                return order == 0 ? one < other : order < 0;
            });
            bool turned = false; // the first has coincided with one of the opposite order
            for (std::size_t first = 0, i = 1; i < here.size(); ++i) {
                if (!std::ranges::equal(cycle(here[first]), cycle(here[i]))) {
                    first = i;
                    turned = false;
                } else if (turned || backwards[here[first]] == backwards[here[i]]) {
                    found_.redundant.push_back(here[i]);
                } else {
                    turned = true;
                    if (normals_[here[i]] != glm::dvec3(0))
                        pairs_.push_back({{here[first], here[i]}});
                }
            }
        }
        std::ranges::sort(found_.redundant);
        std::ranges::sort(pairs_, {}, [](const Pair& pair) { return pair.facets[1]; });
    }

    /// Calls use(start, end) for the places at the ends of a facet's edges.
    template <typename Use> void for_each_edge(std::uint32_t facet, const Use& use) const {
        const auto outline = polygons_.outline(facet);
        for (std::size_t i = 0; i < outline.size(); ++i)
            use(places_[outline[i]], places_[outline[i + 1 == outline.size() ? 0 : i + 1]]);
    }

    void find_strays() {
        for (std::uint32_t pair = 0; pair < pairs_.size(); ++pair)
            for_each_edge(pairs_[pair].facets[0], [&](std::uint32_t start, std::uint32_t end) {
                edges_[edge_of(start, end)].pairs.push_back(pair);
            });
        auto next = found_.redundant.begin();
        for (std::uint32_t facet = 0; facet < polygons_.facets(); ++facet) {
            if (next != found_.redundant.end() && *next == facet)
                ++next;
            else
                count_directions(facet, 1);
        }
        std::vector<std::uint32_t> waiting(pairs_.size());
        for (std::uint32_t pair = 0; pair < pairs_.size(); ++pair)
            waiting[pair] = static_cast<std::uint32_t>(pairs_.size()) - 1 - pair;
        while (!waiting.empty()) {
            Pair& pair = pairs_[waiting.back()];
            waiting.pop_back();
            const int stray = pair.open ? stray_of(pair) : -1;
            if (stray < 0)
                continue;
            pair.open = false;
            found_.redundant.push_back(pair.facets[stray]);
            count_directions(pair.facets[stray], -1);
            for_each_edge(pair.facets[stray], [&](std::uint32_t start, std::uint32_t end) {
                const auto& others = edges_[edge_of(start, end)].pairs;
                waiting.insert(waiting.end(), others.begin(), others.end());
            });
        }
    }

    /// Counts a facet's direction along the edges of pairs.
    void count_directions(std::uint32_t facet, long times) {
        for_each_edge(facet, [&](std::uint32_t start, std::uint32_t end) {
            if (const auto edge = edges_.find(edge_of(start, end)); edge != edges_.end() && start != end)
                edge->second.surplus += start < end ? times : -times;
        });
    }

    /// Which of a pair is a stray; -1 if none.
    int stray_of(const Pair& pair) const {
        int edges = 0, more = 0, less = 0; // often in the first one's direction
        for_each_edge(pair.facets[0], [&](std::uint32_t start, std::uint32_t end) {
            const long surplus = edges_.find(edge_of(start, end))->second.surplus * (start < end ? 1 : -1);
            ++edges;
            more += surplus > 0;
            less += surplus < 0;
        });
        if (less == 0 && 2 * more > edges)
            return 0;
        return more == 0 && 2 * less > edges ? 1 : -1;
    }

    struct Edge {
        long surplus = 0; // how much more often facets run from the lower place to the higher one than back
        std::vector<std::uint32_t> pairs;
    };

    const PolygonSoup& polygons_;
    std::span<const glm::dvec3> normals_;
    std::vector<std::uint32_t> places_;
    std::vector<Pair> pairs_;
    std::unordered_map<std::uint64_t, Edge> edges_; // of pairs
    CoincidentFacets found_;
};

} // namespace

CoincidentFacets find_coincident(const PolygonSoup& polygons, std::span<const glm::dvec3> facet_normals) {
    return CoincidentSearch(polygons, facet_normals).run();
}

PolygonSoup without_facets(const PolygonSoup& polygons, std::span<const std::uint32_t> left_out) {
    PolygonSoup rest;
    rest.vertices = polygons.vertices;
    rest.begins.reserve(polygons.begins.size());
    rest.corners.reserve(polygons.corners.size());
    auto next = left_out.begin();
    for (std::uint32_t facet = 0; facet < polygons.facets(); ++facet) {
        if (next != left_out.end() && *next == facet) {
            ++next;
            continue;
        }
        const auto outline = polygons.outline(facet);
        rest.corners.insert(rest.corners.end(), outline.begin(), outline.end());
        rest.end_facet();
    }
    return rest;
}

} // namespace forceshade
