#include "host/study/stability/stability.h"

#include "host/study/stability/loop.h"
#include "host/study/stability/number.h"
#include "host/study/stability/stability_findings.h"
#include "host/study/stability/worst_rounding.h"

namespace forceshade::study {

StudyData study_stability(StudyRun& run) {
    std::vector<Step> steps = loop_steps(run);
    const auto of_loop = static_cast<std::ptrdiff_t>(steps.size());
    if (!run.scene()) // precision is that of plain surfaces of the study's own
        for (Step& step : number_steps(run))
            steps.push_back(std::move(step));
    std::vector<nlohmann::ordered_json> results = run.run_steps(steps);
    const std::vector<nlohmann::ordered_json> of_number(results.begin() + of_loop, results.end());
    results.resize(static_cast<std::size_t>(of_loop));
    StudyData data = run.data();
    add_loop(data, results);
    data.findings = stability_findings(data);
    if (!run.scene()) {
        add_number(data, of_number);
        std::vector<WorstRounding> worst;
        run.run(worst_rounding_parts(run.options().quick, worst));
        add_worst_rounding(data, worst);
    }
    return data;
}

} // namespace forceshade::study
