#include "host/experiment/trials.h"

#include <algorithm>
#include <numeric>

#include "host/experiment/random.h"

namespace forceshade::experiment {
namespace {

// Each condition `times`, shuffled.
std::vector<std::size_t> shuffled(std::size_t conditions, std::uint64_t times, Random& random) {
    std::vector<std::size_t> order;
    for (std::uint64_t i = 0; i < times; ++i)
        for (std::size_t condition = 0; condition < conditions; ++condition)
            order.push_back(condition);
    for (std::size_t i = order.size(); i > 1; --i)
        std::swap(order[i - 1], order[random.below(i)]);
    return order;
}

} // namespace

std::vector<Trial> trials_of(const Experiment& experiment, const std::string& subject, std::uint64_t session) {
    const ExperimentSpec& spec = experiment.spec;
    const std::size_t conditions = experiment.study.cases.size();
    Random random(spec.seed, subject + "/" + std::to_string(session));
    std::vector<Trial> trials;
    const auto add = [&](std::uint64_t block, std::size_t condition) {
        trials.push_back({trials.size() + 1, block, condition, random.word()});
    };
    for (std::uint64_t done = 0; done < spec.practice;) // each condition before one comes again
        for (const std::size_t condition : shuffled(conditions, 1, random))
            if (done++ < spec.practice)
                add(0, condition);
    if (spec.order == Order::balanced) {
        for (std::uint64_t block = 1; block <= spec.blocks; ++block)
            for (const std::size_t condition : shuffled(conditions, spec.trials / spec.blocks, random))
                add(block, condition);
        return trials;
    }
    const auto order = shuffled(conditions, spec.trials, random);
    for (std::size_t i = 0; i < order.size(); ++i)
        add(1 + i * spec.blocks / order.size(), order[i]);
    return trials;
}

} // namespace forceshade::experiment
