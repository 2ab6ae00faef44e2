#include "host/mesh/coincident.h"

#include <algorithm>
#include <bit>
#include <unordered_map>

#include "host/mesh/weld.h"

namespace forceshade {
namespace {

constexpr std::uint32_t kFree = 0xFFFFFFFFu;

/// A facet's corners by place, from the lowest one on towards the lower of the two beside it.
class Cycle {
public:
    Cycle(const PolygonSoup& polygons, const std::vector<std::uint32_t>& places, std::size_t facet)
        : corners_(&polygons.corners[polygons.begins[facet]]), places_(places),
          count_(polygons.begins[facet + 1] - polygons.begins[facet]) {
        for (std::size_t i = 1; i < count_; ++i)
            if (place(i) < place(first_))
                first_ = i;
        backwards_ = place(first_ == 0 ? count_ - 1 : first_ - 1) < place(first_ + 1 == count_ ? 0 : first_ + 1);
    }
    bool backwards() const { return backwards_; }
    std::uint64_t hash() const {
        std::uint64_t hash = count_;
        for (std::size_t i = 0; i < count_; ++i) {
            hash = (hash ^ (*this)[i]) * 0x9E3779B97F4A7C15u;
            hash ^= hash >> 29;
        }
        return hash;
    }
    /// Forwards or backwards.
    bool coincides(const Cycle& other) const {
        bool equal = count_ == other.count_;
        for (std::size_t i = 0; equal && i < count_; ++i)
            equal = (*this)[i] == other[i];
        return equal;
    }

private:
    std::uint32_t place(std::size_t corner) const { return places_[corners_[corner]]; }
    std::uint32_t operator[](std::size_t i) const {
        const std::size_t at = backwards_ ? first_ + count_ - i : first_ + i;
        return place(at < count_ ? at : at - count_);
    }

    const std::uint32_t* corners_;
    const std::vector<std::uint32_t>& places_;
    std::size_t count_, first_ = 0;
    bool backwards_;
};

struct Pair {
    std::uint32_t facets[2];
    bool open = true; // no stray found
};

class Search {
public:
    Search(const PolygonSoup& polygons, std::span<const glm::dvec3> normals)
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
        const std::size_t slots = std::bit_ceil(2 * polygons_.facets() + 1);
        std::vector<std::uint32_t> table(slots, kFree);
        for (std::uint32_t facet = 0; facet < polygons_.facets(); ++facet) {
            if (polygons_.begins[facet] == polygons_.begins[facet + 1])
                continue;
            const Cycle cycle(polygons_, places_, facet);
            std::size_t slot = cycle.hash() & (slots - 1);
            bool repeats = false;
            std::uint32_t opposite = kFree;
            for (; table[slot] != kFree && !repeats; slot = (slot + 1) & (slots - 1)) {
                const Cycle other(polygons_, places_, table[slot]);
                if (!other.coincides(cycle))
                    continue;
                repeats = other.backwards() == cycle.backwards();
                opposite = repeats ? kFree : table[slot];
            }
            if (repeats) {
                found_.redundant.push_back(facet);
                continue;
            }
            table[slot] = facet;
            if (opposite != kFree && normals_[facet] != glm::dvec3(0))
                pairs_.push_back({{opposite, facet}});
        }
    }

    /// Calls use(start, end) for the places at the ends of a facet's edges.
    template <typename Use> void for_each_edge(std::uint32_t facet, const Use& use) const {
        const std::uint32_t begin = polygons_.begins[facet], end = polygons_.begins[facet + 1];
        for (std::uint32_t i = begin; i < end; ++i)
            use(places_[polygons_.corners[i]], places_[polygons_.corners[i + 1 == end ? begin : i + 1]]);
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
                walk(facet, 1);
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
            walk(pair.facets[stray], -1);
            for_each_edge(pair.facets[stray], [&](std::uint32_t start, std::uint32_t end) {
                const auto& others = edges_[edge_of(start, end)].pairs;
                waiting.insert(waiting.end(), others.begin(), others.end());
            });
        }
    }

    /// Counts a facet's way along the edges of pairs.
    void walk(std::uint32_t facet, long times) {
        for_each_edge(facet, [&](std::uint32_t start, std::uint32_t end) {
            if (const auto edge = edges_.find(edge_of(start, end)); edge != edges_.end() && start != end)
                edge->second.surplus += start < end ? times : -times;
        });
    }

    /// Which of a pair is a stray; -1 if none.
    int stray_of(const Pair& pair) const {
        int edges = 0, more = 0, less = 0; // often along the first one's way
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
        long surplus = 0; // how much more often facets walk from the lower place to the higher one than back
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
    return Search(polygons, facet_normals).run();
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
        rest.corners.insert(rest.corners.end(), polygons.corners.begin() + polygons.begins[facet],
                            polygons.corners.begin() + polygons.begins[facet + 1]);
        rest.begins.push_back(static_cast<std::uint32_t>(rest.corners.size()));
    }
    return rest;
}

} // namespace forceshade
