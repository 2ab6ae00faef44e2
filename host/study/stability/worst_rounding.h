// The worst that single precision does to a law: searched for where it may be worst, not sampled where it is not.
#pragma once

#include "host/study/run/study_run.h"

namespace forceshade::study {

/// A place at which single precision is far from double.
struct WorstRounding {
    std::string law;        /* "mesh of 8 cells, morgenbesser" */
    bool same_facet = true; /* both precisions meet the same facet away from edges of the law; else rounding chose */
    double error = 0;       /* 1: |F32 - F64| over the largest force of the search, K times 2 mm */
    double local = 0;       /* 1: over the force there */
    double turn = 0;        /* deg: between both forces */
    double depth = 0;       /* m */
    glm::dvec3 place{0};    /* m */
    std::size_t evaluations = 0; /* of the law, in each precision */
};

/// A part for each law; `found` must outlive them and receives two a law, at most: the worst of the same facet, and of
/// another one.
std::vector<Part> worst_rounding_parts(bool quick, std::vector<WorstRounding>& found);

/// Adds the table and its finding.
void add_worst_rounding(StudyData& data, const std::vector<WorstRounding>& found);

} // namespace forceshade::study
