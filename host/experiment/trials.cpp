#include "host/experiment/trials.h"

#include <algorithm>
#include <map>

#include "host/random.h"

namespace forceshade::experiment {
namespace {

template <typename T> void shuffle(std::vector<T>& all, Random& random) {
    for (std::size_t i = all.size(); i > 1; --i)
        std::swap(all[i - 1], all[random.below(i)]);
}

// Each of these `times`, shuffled.
std::vector<std::size_t> shuffled(std::size_t count, std::uint64_t times, Random& random) {
    std::vector<std::size_t> order;
    for (std::uint64_t i = 0; i < times; ++i)
        for (std::size_t one = 0; one < count; ++one)
            order.push_back(one);
    shuffle(order, random);
    return order;
}

// The standard comes first in half of the trials of each condition or track, in an order by chance; of an odd number
// chance says which half is the larger.
void place_standards(const Experiment& experiment, std::vector<Trial>& trials, Random& random) {
    std::map<std::size_t, std::vector<Trial*>> units;
    for (Trial& trial : trials)
        units[trial.track.value_or(experiment.tracks.size() + trial.condition)].push_back(&trial);
    for (auto& [unit, of_unit] : units) {
        const std::uint64_t offset = random.below(2);
        shuffle(of_unit, random);
        for (std::size_t i = 0; i < of_unit.size(); ++i)
            of_unit[i]->standard_first = (i + offset) % 2 == 0;
    }
}

} // namespace

std::vector<Trial> trials_of(const Experiment& experiment, const std::string& subject, std::uint64_t session) {
    const ExperimentSpec& spec = experiment.spec;
    const bool tracked = !experiment.tracks.empty();
    const std::size_t conditions = experiment.conditions.size(),
                      units = tracked ? experiment.tracks.size() : conditions;
    Random random(spec.seed, subject + "/" + std::to_string(session));
    std::vector<Trial> trials;
    const auto add = [&](std::uint64_t block, std::size_t condition) {
        trials.push_back({trials.size() + 1, block, condition, random.word()});
    };
    const auto add_unit = [&](std::uint64_t block, std::size_t unit) {
        add(block, tracked ? 0 : unit);
        if (tracked)
            trials.back().track = unit;
    };
    for (std::uint64_t done = 0; done < spec.practice;) // each condition before one comes again
        for (const std::size_t condition : shuffled(conditions, 1, random))
            if (done++ < spec.practice)
                add(0, condition);
    if (spec.order == Order::balanced) {
        for (std::uint64_t block = 1; block <= spec.blocks; ++block)
            for (const std::size_t unit : shuffled(units, spec.trials / spec.blocks, random))
                add_unit(block, unit);
    } else {
        const auto order = shuffled(units, spec.trials, random);
        for (std::size_t i = 0; i < order.size(); ++i)
            add_unit(1 + i * spec.blocks / order.size(), order[i]);
    }
    if (spec.task == Task::compare)
        place_standards(experiment, trials, random);
    return trials;
}

} // namespace forceshade::experiment
