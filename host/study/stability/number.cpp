#include "host/study/stability/number.h"

namespace forceshade::study {

std::vector<Step> number_steps(StudyRun&) {
    return {};
}

void add_number(StudyData&, const std::vector<nlohmann::ordered_json>&) {}

} // namespace forceshade::study
