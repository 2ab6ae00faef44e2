// The order in which names and axes list a document's keys.
#pragma once

#include "host/scene/document.h"

namespace forceshade {

/// Document::order: the same for a document and for its resolved text.
std::vector<std::size_t> key_order(const Document& document);

} // namespace forceshade
