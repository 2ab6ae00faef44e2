#include "host/study/stability/loop.h"

namespace forceshade::study {

std::vector<Step> loop_steps(StudyRun&) {
    return {};
}

void add_loop(StudyData&, const std::vector<nlohmann::ordered_json>&) {}

} // namespace forceshade::study
