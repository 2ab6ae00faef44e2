// Where a look-up is off, and how that shrinks with the spacing of its volume: apart for places whose samples lie in a
// smooth part, and for those whose samples lie on several facets or not all in contact.
#pragma once

#include <string>
#include <vector>

#include "host/prepare/prepared_case.h"
#include "host/study/error_time/subject.h"

namespace forceshade::study::error_time {

/// What is looked up.
struct LookupCase {
    std::string name;       /* "bump of 4 facets, shaded" */
    std::string short_name; /* "bump-4-shaded" */
    std::shared_ptr<const PreparedCase> prepared;
    glm::dvec3 low{0}, high{0};   /* m: where the places are drawn */
    double deepest = 0;           /* m: their penetration */
    double coarsest = 0;          /* m: the largest spacing at which some places lie in a smooth part */
    std::optional<double> across; /* order to be expected across edges: 1 for a kink, 0 for a jump */
    bool flat = false;            /* linear within a facet: both readings are exact */
};

/// The study's own: the bump of 4 facets, shaded and flat, and the coarsest mesh.
std::vector<LookupCase> lookup_cases();

struct LookupError {
    std::string method;          /* "trilinear", "tricubic" */
    std::string place;           /* "smooth", "edge", "boundary" */
    std::size_t places = 0;      /* that are of this kind */
    double rms = 0, largest = 0; /* 1: of the vector's error, of the root mean square force */
    double direction_rms = 0;    /* deg: where both forces are above a thousandth of that */
};

/// At `count` places, with a volume in double. As smooth count places that are so at the coarsest spacing, so that they
/// are the same ones for every spacing up to it.
std::vector<LookupError> lookup_errors(const LookupCase& one, double spacing, std::size_t count);

/// Nothing where there is none to be expected.
std::optional<double> expected_order(const LookupCase& one, const std::string& method, const std::string& place);

} // namespace forceshade::study::error_time
