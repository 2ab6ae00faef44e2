// Finding of the study of energy: which fields have curl, and which no more than sampling leaves.
#pragma once

#include <string>
#include <vector>

#include "host/study/data/study_data.h"

namespace forceshade::study {

/// Of table `curl_maps`: the most and the least of the maps whose curl is above what sampling leaves; those of the
/// schemes in `conservative` are not counted among them, whatever they have. Without the table, or numbers in it,
/// nothing.
void add_curl(const StudyData& data, const std::vector<std::string>& conservative, std::vector<Finding>& findings);

} // namespace forceshade::study
