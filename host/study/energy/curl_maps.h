// Which maps of curl the study of energy makes.
#pragma once

#include <vector>

#include "host/study/energy/curl.h"

namespace forceshade::study {

/// Sections of the bump of 1000 mil, its shadings, and its meshes; `columns` by half as many samples.
std::vector<CurlMap> curl_maps(std::uint64_t columns);

} // namespace forceshade::study
