// What a law gives at one probe position.
#pragma once

#include "host/reference/vector.h"
#include "shaders/shared/layout.h"

namespace forceshade::reference {

template <typename T> struct Contact {
    T depth;            /* m, 0 out of contact */
    Vector<T> force;    /* N */
    Vector<T> unshaded; /* N: what shading "none" would give */
    Vector<T> proxy;    /* m: the contact point on the nominal surface; the probe itself out of contact */
    layout::uint facet; /* layout::kNoFacet out of contact */
};

} // namespace forceshade::reference
