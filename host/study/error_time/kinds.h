// The places at which errors are measured, and their kinds.
#pragma once

#include <array>
#include <vector>

#include "host/study/error_time/subject.h"
#include "host/touch/force_at.h"

namespace forceshade::study::error_time {

/// The kind of a place, by the forces on a small ring about it. flat: the smooth shape is a plane there; facet: it is
/// curved, and the law has one facet; edge: facets meet; rim: the smooth shape itself has an edge; boundary: the place
/// is so shallow, or as little above the surface, that contact begins or ends nearby.
enum class Kind { flat, facet, edge, rim, boundary };
inline constexpr std::array kKinds{Kind::flat, Kind::facet, Kind::edge, Kind::rim, Kind::boundary};
const char* name_of(Kind kind);

/// Classifies places of a law by kind.
class KindOf {
public:
    /// `subject` must outlive it.
    KindOf(const Subject& subject, const Variant& variant);
    Kind operator()(const TouchPlace& place);

private:
    const Subject& subject_;
    PreparedCase plain_; /* without shading */
    StaticForce<double> facets_;
};

/// The places at which a law is compared with the truth, and their kinds.
struct KindPlaces {
    std::vector<TouchPlace> at; /* the subject's own come first */
    std::vector<Kind> kinds;
    std::size_t shared = 0; /* how many the subject's own are */
};

/// The subject's places and more, so that each kind has `extents.places_of_kind` where the surface has such places.
KindPlaces places_of(const Subject& subject, const Variant& variant, const Extents& extents);

} // namespace forceshade::study::error_time
