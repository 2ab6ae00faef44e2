#include "host/report/sweep_findings.h"

#include <algorithm>

#include <fmt/format.h>

#include "host/report/words.h"

namespace forceshade::report {
namespace {

std::vector<const CaseRecord*> with_field(const Sweep& sweep) {
    std::vector<const CaseRecord*> cases;
    for (const CaseRecord& record : sweep.cases)
        if (record.voxels > 0)
            cases.push_back(&record);
    return cases;
}

std::string agreement(const std::vector<const CaseRecord*>& cases) {
    std::uint64_t compared = 0, differing = 0, beyond = 0;
    for (const CaseRecord* one : cases) {
        compared += one->error.compared;
        differing += one->error.differing;
        beyond += one->error.beyond;
    }
    std::string text =
        fmt::format("Of {} voxels compared with the CPU oracle in the same precision, ", count_text(compared));
    if (compared == 0)
        return "No voxel was compared with the CPU oracle.";
    if (differing == 0)
        return text + "all are equal bit for bit.";
    text += fmt::format("{} differ{}", count_text(differing), differing == 1 ? "s" : "");
    return text + (beyond == 0 ? ", none by more than rounding allows."
                               : fmt::format(", {} of them by more than rounding allows: those volumes are not to be "
                                             "trusted.",
                                             count_text(beyond)));
}

std::string error(const std::vector<const CaseRecord*>& cases) {
    const CaseRecord& worst =
        **std::ranges::max_element(cases, {}, [](const CaseRecord* one) { return one->error.relative(); });
    if (worst.error.relative() == 0)
        return "No force differs from the oracle in double precision.";
    return fmt::format("The largest error against the oracle in double precision is {} of the case's largest force "
                       "({} N), in {}.",
                       number_text(worst.error.relative(), 2), number_text(worst.error.largest, 2), worst.name);
}

std::string force(const std::vector<const CaseRecord*>& cases) {
    const auto largest = [](const CaseRecord* one) { return one->largest_force; };
    const CaseRecord &most = **std::ranges::max_element(cases, {}, largest),
                     &least = **std::ranges::min_element(cases, {}, largest);
    if (most.largest_force == least.largest_force)
        return fmt::format("The largest force is {} N in every case.", number_text(most.largest_force, 3));
    return fmt::format("The largest force is {} N, in {}; the case whose largest is least, {}, reaches {} N.",
                       number_text(most.largest_force, 3), most.name, least.name, number_text(least.largest_force, 3));
}

std::string cost(const std::vector<const CaseRecord*>& cases) {
    const auto kernel = [](const CaseRecord* one) { return one->engine_times.kernel; };
    const CaseRecord &dearest = **std::ranges::max_element(cases, {}, kernel),
                     &cheapest = **std::ranges::min_element(cases, {}, kernel);
    if (kernel(&dearest) <= 0)
        return "";
    std::string text = fmt::format("The dearest case took {} ms in the kernel, {}",
                                   number_text(1e3 * kernel(&dearest), 3), dearest.name);
    if (cases.size() > 1 && kernel(&cheapest) > 0)
        text += fmt::format("; that is {} times the cheapest, {}", number_text(kernel(&dearest) / kernel(&cheapest), 2),
                            cheapest.name);
    return text + ".";
}

std::string left_out(const std::vector<const CaseRecord*>& cases) {
    std::uint64_t voxels = 0, evaluated = 0;
    for (const CaseRecord* one : cases) {
        voxels += one->voxels;
        evaluated += one->evaluated;
    }
    if (evaluated >= voxels)
        return "";
    return fmt::format("Only {} of {} voxels had to be evaluated ({} %); the others are copies or free space.",
                       count_text(evaluated), count_text(voxels),
                       number_text(100 * static_cast<double>(evaluated) / static_cast<double>(voxels), 2));
}

std::string stages(const std::vector<const CaseRecord*>& cases) {
    double engine = 0, files = 0;
    for (const CaseRecord* one : cases) {
        engine += one->engine_times.sum();
        files += one->volume_times.sum();
    }
    if (engine + files <= 0)
        return "";
    return fmt::format("Of the time by stage, {:.0f} % went into evaluating the fields and {:.0f} % into writing, "
                       "reading back and hashing the volumes.",
                       100 * engine / (engine + files), 100 * files / (engine + files));
}

std::string paths(const Sweep& sweep) {
    std::uint64_t count = 0, unstable = 0, samples = 0;
    for (const CaseRecord& one : sweep.cases)
        if (one.paths) {
            count += one.paths->paths;
            unstable += one.paths->unstable;
            samples += one.paths->samples;
        }
    if (count == 0)
        return "";
    return fmt::format("{} paths with {} samples were followed; {} left {} bound.", count_text(count),
                       count_text(samples), unstable == 0 ? "none" : count_text(unstable),
                       unstable == 1 ? "its" : "their");
}

} // namespace

std::vector<study::Finding> sweep_findings(const Sweep& sweep) {
    std::vector<study::Finding> findings;
    const auto add = [&](const char* name, const std::string& text) {
        if (!text.empty())
            findings.push_back({name, text});
    };
    if (const std::vector<const CaseRecord*> cases = with_field(sweep); !cases.empty()) {
        add("agreement", agreement(cases));
        add("largest_error", error(cases));
        add("largest_force", force(cases));
        add("dearest_case", cost(cases));
        add("evaluated", left_out(cases));
        add("stages", stages(cases));
    }
    add("paths", paths(sweep));
    return findings;
}

} // namespace forceshade::report
