#include "host/cli/command.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>

#include "host/error.h"
#include "host/program.h"

namespace forceshade {

EngineOptions engine_options(const CommonOptions& common, bool needs_f64) {
    if (common.engine == "cpu" && !common.gpu.empty())
        throw UsageError("--gpu and --engine cpu exclude each other");
    EngineOptions options;
    options.cpu = common.engine == "cpu";
    options.gpu = common.gpu;
    options.needs_f64 = needs_f64;
    options.validation = common.validation_layers;
    options.cache = default_cache_folder();
    return options;
}

std::vector<Override> overrides(const CommonOptions& common) {
    if (common.precision.empty())
        return {};
    return {{"run.precision", common.precision}};
}

void print_warnings(const std::vector<std::string>& warnings, const CommonOptions& common) {
    if (!common.quiet)
        for (const std::string& warning : warnings)
            remark("warning: {}\n", warning);
}

Study load_study(const std::string& path, const CommonOptions& common) {
    const std::vector<Override> replaced = overrides(common);
    Study study = path.empty() ? default_study(replaced) : read_study(path, replaced);
    print_warnings(study.warnings, common);
    return study;
}

bool any_f64(const Study& study) {
    return std::any_of(study.cases.begin(), study.cases.end(),
                       [](const Case& one) { return one.scene.precision == Precision::f64; });
}

void print_data(const std::string& text) {
    if (std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0)
        return;
    if (errno != EPIPE) // a reader that has seen enough, such as head, is no error
        throw IoError("cannot write to standard output");
}

} // namespace forceshade
