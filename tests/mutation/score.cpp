// mutation_score [--kernel NAME] [--precision f32] [--sample N] [--seed S] ...: how many kernels with one instruction
// changed `forceshade validate` tells from the intact ones. See README.md.
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <stdexcept>

#include <fnmatch.h>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tests/mutation/mutants.h"
#include "tests/mutation/trial.h"

namespace forceshade::mutation {
namespace {

struct Arguments {
    std::vector<std::string> kernels;
    std::string precision, scenes = FORCESHADE_SCENES, known = FORCESHADE_KNOWN, dump;
    std::vector<std::string> scene_names, only;
    std::size_t sample = 200;
    std::uint64_t seed = 1;
    unsigned jobs = 1, seconds = 20;
    bool verbose = false, coverage = false;
};

// Survivors that were looked at, one a line: "KERNEL PRECISION KEY | REASON", all but the reason with * for any text.
class Known {
public:
    explicit Known(const std::string& file) {
        std::ifstream text(file);
        if (!text)
            throw std::runtime_error(fmt::format("{} cannot be read", file));
        for (std::string line; std::getline(text, line);) {
            const std::size_t bar = line.find(" | ");
            if (line.empty() || line[0] == '#')
                continue;
            if (bar == std::string::npos)
                throw std::runtime_error(fmt::format("{}: a line without \" | \" and a reason: {}", file, line));
            reasons_.emplace_back(line.substr(0, bar), line.substr(bar + 3));
        }
    }
    /// Empty: it was not.
    std::string reason(const std::string& kernel, const Mutant& mutant) const {
        const std::string whole = kernel + " " + mutant.key;
        for (const auto& [pattern, reason] : reasons_)
            if (fnmatch(pattern.c_str(), whole.c_str(), 0) == 0)
                return reason;
        return "";
    }

private:
    std::vector<std::pair<std::string, std::string>> reasons_;
};

// The first `count` numbers of a random order of `all`, the same on every machine.
std::vector<std::size_t> drawn(std::size_t all, std::size_t count, std::uint64_t seed) {
    std::vector<std::size_t> order(all);
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::mt19937_64 random(seed);
    count = count == 0 ? all : std::min(count, all);
    for (std::size_t i = 0; i < count; ++i)
        std::swap(order[i], order[i + random() % (all - i)]);
    order.resize(count);
    return order;
}

struct Score {
    std::size_t mutants = 0, dead = 0, known = 0;
    std::size_t equivalent = 0;      // survivors whose results cannot differ; they are not live either
    std::map<End, std::size_t> ends; // of all that are not dead

    std::size_t live() const { return mutants - dead - equivalent; }
    std::size_t survived() const { return (ends.contains(End::survived) ? ends.at(End::survived) : 0) - equivalent; }
    std::size_t killed() const { return live() - survived(); }
};

class KernelScore {
public:
    KernelScore(const Kernel& kernel, const std::vector<PreparedCase>& scenes, const Known& known,
                const Arguments& arguments)
        : kernel_(kernel), scenes_(scenes), known_(known), arguments_(arguments),
          code_(kernel.words, kernel.with_lines), kills_(scenes.size(), 0) {
        choose();
        if (arguments.dump.empty())
            coverage_ = coverage_of(kernel, code_, scenes, blocks());
    }

    Score run() {
        if (!arguments_.dump.empty()) {
            dump();
            return score_;
        }
        if (std::ranges::none_of(scenes_, [&](const PreparedCase& scene) { return is_for(kernel_, scene); }))
            throw std::runtime_error(fmt::format("no scene is for {}", kernel_.name));
        const std::vector<std::uint64_t> host_updates = host_updates_of(kernel_, scenes_);
        if (arguments_.coverage)
            print_coverage();
        const auto trial = [&](std::size_t i) {
            Changed changed(code_);
            chosen_[i].apply(changed);
            return Trial{changed.words(), host_updates, live_scenes(chosen_[i])};
        };
        const auto done = [&](std::size_t i, const Outcome& outcome) { count(chosen_[i], outcome); };
        try_kernels(kernel_, scenes_, chosen_.size(), trial, done, arguments_.jobs, arguments_.seconds);
        return score_;
    }

private:
    void choose() {
        std::vector<Mutant> all = mutants_of(code_);
        if (!arguments_.only.empty()) {
            std::erase_if(all, [&](const Mutant& one) {
                return std::ranges::none_of(
                    arguments_.only, [&](const std::string& text) { return one.key.find(text) != std::string::npos; });
            });
            chosen_ = std::move(all);
            return;
        }
        for (const std::size_t i : drawn(all.size(), arguments_.sample, arguments_.seed))
            chosen_.push_back(all[i]);
    }

    // Those of the mutants, or all.
    std::vector<std::size_t> blocks() const {
        std::set<std::size_t> blocks;
        for (const Mutant& mutant : chosen_)
            blocks.insert(mutant.block);
        for (std::size_t block = 0; arguments_.coverage && block < code_.blocks().size(); ++block)
            blocks.insert(block);
        return {blocks.begin(), blocks.end()};
    }

    // Where the block runs; first the scenes that showed most so far.
    std::vector<std::size_t> live_scenes(const Mutant& mutant) const {
        std::vector<std::size_t> live;
        if (mutant.unread)
            return live;
        for (std::size_t scene = 0; scene < scenes_.size(); ++scene)
            if (coverage_[scene][mutant.block])
                live.push_back(scene);
        std::ranges::stable_sort(live, std::greater<>(), [&](std::size_t scene) { return kills_[scene]; });
        return live;
    }

    // For spirv-dis and spirv-val.
    void dump() const {
        for (std::size_t i = 0; i < chosen_.size(); ++i) {
            Changed changed(code_);
            chosen_[i].apply(changed);
            const Words words = changed.words();
            const std::string file = fmt::format("{}/{}.{}.spv", arguments_.dump, name(), i);
            std::ofstream(file, std::ios::binary)
                .write(reinterpret_cast<const char*>(words.data()), std::streamsize(4 * words.size()));
            fmt::print("{}: {} {}\n", file, chosen_[i].place, chosen_[i].key);
        }
    }

    void print_coverage() const {
        for (std::size_t block = 0; block < code_.blocks().size(); ++block) {
            std::string names;
            for (std::size_t scene = 0; scene < scenes_.size(); ++scene)
                if (coverage_[scene][block])
                    names += " " + scenes_[scene].one.name.substr(0, 2);
            fmt::print("{} {:<30} {:<28}{}\n", name(), code_.blocks()[block].function,
                       code_.line(code_.blocks()[block].first), names.empty() ? " never" : names);
        }
    }

    void count(const Mutant& mutant, const Outcome& outcome) {
        ++score_.mutants;
        const std::vector<std::size_t> live = live_scenes(mutant);
        if (live.empty()) {
            ++score_.dead;
            if (arguments_.verbose)
                fmt::print("{} dead      {:<24} {}\n", name(), mutant.place, mutant.key);
            return;
        }
        ++score_.ends[outcome.end];
        if (outcome.end == End::differs || outcome.end == End::error)
            ++kills_[outcome.scene];
        if (outcome.end != End::survived) {
            if (arguments_.verbose)
                fmt::print("{} {:<9} {:<24} {} {}\n", name(), name_of(outcome.end), mutant.place, mutant.key,
                           outcome.end == End::differs || outcome.end == End::error ? scenes_[outcome.scene].one.name
                                                                                    : "");
        } else {
            print_survivor(mutant, live, outcome.left_to_host);
        }
        std::fflush(stdout);
    }

    void print_survivor(const Mutant& mutant, const std::vector<std::size_t>& live, bool left_to_host) {
        std::string reason = known_.reason(name(), mutant);
        if (reason.empty() && left_to_host)
            reason = "host: it leaves other steps to the host, which finds the same";
        const bool equivalent = reason.starts_with("equivalent") || reason.starts_with("host");
        score_.equivalent += equivalent;
        score_.known += !reason.empty() && !equivalent;
        std::vector<std::string> names;
        for (const std::size_t scene : live)
            names.push_back(scenes_[scene].one.name.substr(0, 2));
        std::ranges::sort(names);
        fmt::print("{} {}  {:<24} {}; live in {}{}\n", name(), equivalent ? "same    " : "SURVIVED", mutant.place,
                   mutant.key, fmt::join(names, " "), reason.empty() ? "" : "; known: " + reason);
    }

    static const char* name_of(End end) {
        switch (end) {
        case End::survived:
            return "survived";
        case End::differs:
            return "differs";
        case End::error:
            return "error";
        case End::crash:
            return "crash";
        case End::time:
            return "time";
        }
        return "";
    }

    std::string name() const {
        return fmt::format("{} {}", kernel_.name, kernel_.precision == Precision::f32 ? "f32" : "f64");
    }

    const Kernel& kernel_;
    const std::vector<PreparedCase>& scenes_;
    const Known& known_;
    const Arguments& arguments_;
    KernelCode code_;
    std::vector<std::vector<bool>> coverage_; // by scene and block
    std::vector<std::size_t> kills_;          // by scene
    std::vector<Mutant> chosen_;
    Score score_;
};

std::string percent(std::size_t part, std::size_t all) {
    return all == 0 ? "-" : fmt::format("{:.1f} %", 100.0 * double(part) / double(all));
}

int run(const Arguments& arguments) {
    std::vector<PreparedCase> scenes = load_scenes(arguments.scenes);
    if (!arguments.scene_names.empty())
        std::erase_if(scenes, [&](const PreparedCase& scene) {
            return std::ranges::none_of(arguments.scene_names,
                                        [&](const std::string& name) { return scene.one.name.starts_with(name); });
        });
    const Known known(arguments.known);
    std::string table =
        fmt::format("{:<10} {:>4} {:>8} {:>5} {:>10} {:>5} {:>7} {:>7} {:>6} {:>6} {:>5} {:>8} {:>6} {:>8}\n", "kernel",
                    "", "mutants", "dead", "equivalent", "live", "killed", "differs", "error", "crash", "time",
                    "survived", "known", "score");
    bool all_known = true;
    for (const Kernel& kernel : kernels()) {
        const bool f32 = kernel.precision == Precision::f32;
        if ((!arguments.precision.empty() && (arguments.precision == "f32") != f32) ||
            (!arguments.kernels.empty() && std::ranges::count(arguments.kernels, kernel.name) == 0))
            continue;
        const Score score = KernelScore(kernel, scenes, known, arguments).run();
        const auto of = [&](End end) { return score.ends.contains(end) ? score.ends.at(end) : 0; };
        table += fmt::format("{:<10} {:>4} {:>8} {:>5} {:>10} {:>5} {:>7} {:>7} {:>6} {:>6} {:>5} {:>8} {:>6} {:>8}\n",
                             kernel.name, f32 ? "f32" : "f64", score.mutants, score.dead, score.equivalent,
                             score.live(), score.killed(), of(End::differs), of(End::error), of(End::crash),
                             of(End::time), score.survived(), score.known, percent(score.killed(), score.live()));
        all_known = all_known && score.known == score.survived();
    }
    fmt::print("{}", table);
    return all_known ? 0 : 1;
}

} // namespace
} // namespace forceshade::mutation

int main(int argc, char** argv) {
    forceshade::mutation::Arguments arguments;
    CLI::App app("How many kernels with one instruction changed validate tells from the intact ones", "mutation_score");
    app.add_option("--kernel", arguments.kernels, "field, path, mesh_field or mesh_path; default: all");
    app.add_option("--precision", arguments.precision, "f32 or f64; default: both");
    app.add_option("--sample", arguments.sample, "mutants of each kernel, drawn at random; 0: all")
        ->capture_default_str();
    app.add_option("--seed", arguments.seed, "of the draw")->capture_default_str();
    app.add_option("--only", arguments.only, "instead of a draw, the mutants with one of these texts in their key");
    app.add_option("--scenes", arguments.scene_names, "scenes whose names begin so; default: all");
    app.add_option("--folder", arguments.scenes, "of the scenes")->capture_default_str();
    app.add_option("--known", arguments.known, "file of survivors that were looked at")->capture_default_str();
    app.add_option("--jobs", arguments.jobs, "processes at a time")->capture_default_str();
    app.add_option("--seconds", arguments.seconds, "of processor time that a mutant may take for a scene")
        ->capture_default_str();
    app.add_option("--dump", arguments.dump, "a folder for the mutants' SPIR-V; none is run then");
    app.add_flag("--verbose", arguments.verbose, "names every mutant, not only survivors");
    app.add_flag("--coverage", arguments.coverage, "names the scenes in which each block runs");
    CLI11_PARSE(app, argc, argv);
    // Small scenes: kernels compile longer than they run. The results are the same bits.
    setenv("GALLIVM_PERF", "nopt", 0);
    setenv("MESA_SHADER_CACHE_DISABLE", "true", 1);
    try {
        return forceshade::mutation::run(arguments);
    } catch (const std::exception& error) {
        fmt::print(stderr, "error: {}\n", error.what());
        return 2;
    }
}
