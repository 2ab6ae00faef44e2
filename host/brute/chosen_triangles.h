// Which triangles of a mesh the referee looks at.
#pragma once

#include <vector>

#include "host/brute/answer.h"
#include "host/mesh/mesh.h"

namespace forceshade::brute {

struct ChosenTriangles {
    std::vector<std::size_t> once;    /* all but those of redundant facets */
    std::vector<std::size_t> touched; /* of these, what has a height beyond rounding; all with an area if none has */
    Real noise = 0;                   /* m: what places may differ by; 0 if all heights are beyond rounding */
};

ChosenTriangles choose_triangles(const Mesh& mesh);

} // namespace forceshade::brute
