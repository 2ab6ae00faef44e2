#include "host/study/error_time/kinds.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/touch/angle.h"
#include "host/touch/force_at.h"

namespace forceshade::study::error_time {
namespace {

constexpr std::size_t kTriesOfKinds = 100, kTriesOfRare = 10; // draws for each place of a kind
constexpr double kSmoothTurn = 5 * kDegree;                   // across a ring; more is an edge of the smooth shape
constexpr double kFacetTurn = 0.5 * kDegree;                  // across a ring; less is not an edge of facets
constexpr double kFlatTurn = 0.01 * kDegree;                  // across a ring; more is curved
constexpr std::size_t kRing = 8;                              // places of a ring

PreparedCase unshaded(PreparedCase prepared) {
    prepared.one.scene.force.shading = Shading::none;
    prepared.one.scene.texture.reset();
    return prepared;
}

} // namespace

const char* name_of(Kind kind) {
    constexpr const char* kNames[] = {"flat", "facet", "edge", "rim", "boundary"};
    return kNames[static_cast<std::size_t>(kind)];
}

KindOf::KindOf(const Subject& subject, const Variant& variant)
    : subject_(subject), plain_(unshaded(*variant.prepared)), facets_(plain_) {}

Kind KindOf::operator()(const TouchPlace& place) {
    const glm::dvec3 across = std::abs(place.normal.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    glm::dvec3 u = reference::cross(place.normal, across);
    u /= reference::length(u);
    const glm::dvec3 v = reference::cross(place.normal, u);
    // The largest turn of the force on a ring about the place.
    const auto turn_of = [&](const auto& force_at) {
        const glm::dvec3 middle = force_at(place);
        double largest = 0;
        for (std::size_t i = 0; i < kRing; ++i) {
            const double angle = 2 * std::numbers::pi * static_cast<double>(i) / kRing;
            TouchPlace near = place;
            near.at += subject_.scale.ring() * (std::cos(angle) * u + std::sin(angle) * v);
            if (const glm::dvec3 force = force_at(near); touches(force) && touches(middle))
                largest = std::max(largest, angle_between(middle, force));
        }
        return largest;
    };
    const double smooth_turn = turn_of(subject_.force);
    const double facet_turn = turn_of([&](const TouchPlace& at) { return facets_.force(facets_.input(at)); });
    if (smooth_turn > kSmoothTurn)
        return Kind::rim;
    if (facet_turn > kFacetTurn)
        return Kind::edge;
    if (place.depth < subject_.scale.skin())
        return Kind::boundary;
    return smooth_turn < kFlatTurn && facet_turn < kFlatTurn ? Kind::flat : Kind::facet;
}

KindPlaces places_of(const Subject& subject, const Variant& variant, const Extents& extents) {
    KindOf kind_of(subject, variant);
    KindPlaces all{{}, {}, subject.places.size()};
    std::array<std::size_t, kKinds.size()> counts{};
    const auto add = [&](const TouchPlace& place, Kind kind) {
        all.at.push_back(place);
        all.kinds.push_back(kind);
        ++counts[static_cast<std::size_t>(kind)];
    };
    for (const TouchPlace& place : subject.places)
        add(place, kind_of(place));
    PlaceDraw draw(subject, *variant.prepared, 2);
    const std::size_t wanted = extents.places_of_kind;
    for (std::size_t tries = 0; tries < kTriesOfKinds * wanted; ++tries) {
        const bool early = tries < kTriesOfRare * wanted; // a kind not met by then does not exist
        if (std::ranges::all_of(counts, [&](std::size_t count) { return count >= wanted || (count == 0 && !early); }))
            break;
        if (const auto place = draw())
            if (const Kind kind = kind_of(*place); counts[static_cast<std::size_t>(kind)] < wanted)
                add(*place, kind);
    }
    // As far above the surface as the shallow ones are below it: there should be no force.
    for (std::size_t i = 0, end = all.at.size(); i < end; ++i)
        if (all.kinds[i] == Kind::boundary) {
            TouchPlace above = all.at[i];
            above.at += 2 * above.depth * above.normal;
            above.depth = -above.depth;
            if (!touches(subject.force(above)))
                add(above, Kind::boundary);
        }
    return all;
}

} // namespace forceshade::study::error_time
