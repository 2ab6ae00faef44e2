// What commands have in common.
#include "host/cli/command.h"

#include <cerrno>
#include <cstdio>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include "host/error.h"
#include "host/field/engine.h"
#include "host/output/files.h"
#include "host/output/kept.h"
#include "host/renderer/renderer_engine.h"
#include "host/spelling.h"

namespace forceshade {

EngineOptions device_options(const CommonOptions& common, bool needs_f64) {
    if (common.engine == "cpu" && !common.gpu.empty())
        throw UsageError("--gpu and --engine cpu exclude each other");
    EngineOptions options;
    options.cpu = common.engine == "cpu";
    options.gpu = common.gpu;
    options.needs_f64 = needs_f64;
    options.validation = common.validation_layers;
    options.cache = common.no_cache ? "" : default_cache_folder();
    return options;
}

SelectedEngine select_engine(const CommonOptions& common, bool needs_f64, const Workload& work) {
    SelectedEngine selected{device_options(common, needs_f64), ""};
    if (work.rubs && (common.engine == "gpu" || !common.gpu.empty()))
        throw UsageError(kRubsOnCpu);
    if (common.engine != "auto" || !common.gpu.empty() || common.validation_layers)
        return selected;
    EngineChoice choice = choose_engine(work, needs_f64);
    selected.options.cpu = choice.cpu;
    selected.options.gpu = std::move(choice.gpu);
    selected.why = std::move(choice.why);
    return selected;
}

std::unique_ptr<Engine> make_engine(const SelectedEngine& selected, const CommonOptions& common) {
    if (!selected.why.empty())
        note(common, "engine: {}\n", selected.why);
    return make_engine(selected.options);
}

void refuse_engine(const CommonOptions& common) {
    if (common.engine != "auto" || !common.gpu.empty())
        throw UsageError("--renderer takes the place of an engine: leave --engine and --gpu out");
}

std::unique_ptr<Engine> make_engine(const std::string& renderer, const PreparedCase& prepared,
                                    const CommonOptions& common, const Workload& work) {
    if (renderer.empty())
        return make_engine(select_engine(common, prepared.one.scene.precision == Precision::f64, work), common);
    device_options(common, false); // refuses --gpu with --engine cpu
    refuse_engine(common);
    return make_renderer_engine(parse_renderer(renderer), prepared);
}

void describe_renderer(Options& options, std::string& renderer) {
    options.optional("--renderer LIBRARY[:OPTIONS]", renderer,
                     "forces by a shared library of your own in place of the oracle's (forceshade_renderer.h); score "
                     "and validate hold it against the oracle");
}

std::vector<Precision> precisions_of(const CommonOptions& common, bool f64) {
    if (!common.precision.empty())
        return {common.precision == "f64" ? Precision::f64 : Precision::f32};
    return f64 ? std::vector{Precision::f32, Precision::f64} : std::vector{Precision::f32};
}

std::vector<Override> overrides(const CommonOptions& common) {
    if (common.precision.empty())
        return {};
    return {{"run.precision", common.precision}};
}

void print_stage_times(const EngineTimes& engine, const VolumeTimings& files) {
    spdlog::debug("stages: prepare {:.3f} s, engine {:.3f} s, encode {:.3f} s, check against the oracle {:.3f} s, "
                  "flush {:.3f} s, read back {:.3f} s, hash {:.3f} s",
                  engine.prepare, engine.sum() - engine.prepare, files.encode, files.check, files.flush,
                  files.read_back, files.hash);
}

void print_warnings(const std::vector<std::string>& warnings, const CommonOptions& common) {
    if (!common.quiet)
        for (const std::string& warning : warnings)
            print_note("warning: {}\n", warning);
}

Case load_scene(const std::string& path, const CommonOptions& common) {
    std::vector<std::string> warnings;
    Case one = read_scene(path, overrides(common), &warnings);
    spdlog::debug("scene: {}, in {} precision", path, one.scene.precision == Precision::f32 ? "single" : "double");
    print_warnings(warnings, common);
    return one;
}

PreparedCase prepare_scene(CasePreparation& preparation, Case one, const CommonOptions& common) {
    std::string why;
    PreparedCase prepared = preparation.prepare_open(std::move(one), why);
    if (!why.empty())
        note(common, "{} (--precision f32 takes it all the same)\n", why);
    return prepared;
}

Study load_study(const std::string& path, const CommonOptions& common, const CaseChoice& choice) {
    const std::vector<Override> replaced = overrides(common);
    Study study = path.empty() ? default_study(replaced, choice) : read_study(path, replaced, {}, choice);
    print_warnings(study.warnings, common);
    return study;
}

std::vector<std::string> case_names(const std::string& path) {
    std::vector<std::string> names;
    for (const Case& one : (path.empty() ? default_study() : read_study(path)).cases)
        names.push_back(one.name);
    return names;
}

bool may_write(const std::vector<std::filesystem::path>& files, const CommonOptions& common) {
    if (common.overwrite && common.no_clobber)
        throw UsageError("--overwrite and --no-clobber exclude each other");
    std::vector<std::filesystem::path> there;
    std::error_code ignored;
    for (const std::filesystem::path& file : files)
        if (std::filesystem::is_regular_file(file, ignored)) // a device or a pipe loses no data
            there.push_back(file);
    if (there.empty() || common.overwrite)
        return true;
    const std::string names =
        there.front().string() + (there.size() > 1 ? fmt::format(" and {} more", there.size() - 1) : "");
    if (!common.no_clobber)
        throw UsageError(
            "{} {} there already: --overwrite replaces what is there, --no-clobber leaves it; or choose another name",
            names, there.size() > 1 ? "are" : "is");
    note(common, "{} {} there already and stay{} (--no-clobber)\n", names, there.size() > 1 ? "are" : "is",
         there.size() > 1 ? "" : "s");
    keep_files(there);
    return there.size() < files.size();
}

void refuse_replacing(const std::vector<std::pair<std::string, std::filesystem::path>>& written,
                      const std::vector<std::filesystem::path>& read) {
    std::error_code ignored; // a missing file is not the same one
    for (const auto& [name, output] : written)
        for (const std::filesystem::path& input : read)
            if (std::filesystem::equivalent(output, input, ignored))
                throw UsageError("{} would replace {}, which is read; choose another name", name, input.string());
}

std::string full_path(const std::filesystem::path& file) {
    return std::filesystem::absolute(file).lexically_normal().string();
}

void refuse_unknown(const char* what, const std::string& word, const std::vector<std::string>& names) {
    const std::string_view meant = nearest(word, names);
    throw UsageError("no {} \"{}\"{}; there are {}", what, word,
                     meant.empty() ? "" : fmt::format(", did you mean {}?", meant), fmt::join(names, ", "));
}

void print_data(const std::string& text) {
    draw_line(""); // both may be the same terminal
    if (std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0)
        return;
    if (errno != EPIPE) // a reader that has seen enough, such as head, is not an error
        throw IoError("cannot write to standard output");
}

namespace {

// "1200" or "1200x800".
void read_size(const std::string& text, picture::Look& look) {
    constexpr int kLeast = 400, kMost = 8000; // pixels
    const std::size_t x = text.find('x');
    const auto number = [&](std::string_view digits) {
        if (const auto value = number_in(digits, kLeast, kMost))
            return *value;
        throw UsageError("--size {}: write a width in pixels, or WIDTHxHEIGHT, each from {} to {}", text, kLeast,
                         kMost);
    };
    look.width = number(std::string_view(text).substr(0, x));
    look.most_height = x == std::string::npos ? 0 : number(std::string_view(text).substr(x + 1));
}

} // namespace

void describe_look(Options& options, picture::Look& look) {
    options.optional("--title TEXT", look.title, "of the pictures; by default what they show, in words");
    options.read(
        "--size PIXELS", [&look](const std::string& text) { read_size(text, look); },
        "of the pictures in pixels: a width, or WIDTHxHEIGHT; by default 1400, as high as they need");
}

double option_quantity(const std::string& flag, const std::string& text, Dimension dimension) {
    try {
        return parse_quantity(text, dimension);
    } catch (const UsageError& error) {
        throw UsageError("{}: {}", flag, error.what());
    }
}

void refuse_unused(const picture::Endings& endings, bool as_by_default) {
    if (!endings.any() && !as_by_default)
        throw UsageError("these options need a picture: add --also png, svg or pdf");
}

} // namespace forceshade
