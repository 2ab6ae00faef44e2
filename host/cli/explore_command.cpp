#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/cli/command.h"
#include "host/error.h"
#include "host/explore/explore.h"
#include "host/field/scene_mesh.h"
#include "host/remark.h"
#include "host/sweep/progress.h"

namespace forceshade {
namespace {

struct ExploreArguments {
    std::string scene, paths, out;
};

// The same file by whatever name; one that is not there is no other's.
bool is_same_file(const std::filesystem::path& a, const std::filesystem::path& b) {
    std::error_code ignored;
    return std::filesystem::equivalent(a, b, ignored);
}

void check(const ExploreArguments& arguments, const CommonOptions& common) {
    if (common.engine != "cpu")
        throw UsageError("explore has no kernel for a GPU yet: say --engine cpu, and it runs on the CPU oracle");
    engine_options(common, false); // refuses --gpu beside it
    const std::string extension = std::filesystem::path(arguments.out).extension().string();
    if (extension == ".exr")
        throw UsageError(
            fmt::format("--out {}: explored paths cannot be written as OpenEXR yet; name a .csv file", arguments.out));
    if (extension != ".csv")
        throw UsageError(
            fmt::format("--out {}: explored paths are a CSV file, so its name ends in .csv", arguments.out));
    for (const std::string& input : {arguments.paths, arguments.scene})
        if (is_same_file(arguments.out, input))
            throw UsageError(
                fmt::format("--out {} would replace {}, which is read; choose another name", arguments.out, input));
}

std::string as_json(const ExploreResult& result, const ExploreArguments& arguments) {
    nlohmann::ordered_json json;
    json["out"] = arguments.out;
    json["samples"] = result.samples;
    json["paths"] = result.paths;
    json["samples_in_contact"] = result.in_contact;
    json["contact_share"] = static_cast<double>(result.in_contact) / static_cast<double>(result.samples);
    json["largest_force_N"] = result.largest_force;
    json["unfinished"] = result.unfinished;
    json["seconds_per_sample"] = result.law_seconds / static_cast<double>(result.samples);
    return json.dump(2) + "\n";
}

void print_outcome(const ExploreResult& result, const ExploreArguments& arguments) {
    const auto samples = static_cast<double>(result.samples);
    remark("{}: {} sample{} on {} path{}, {:.3g} % in contact, largest force {:.4g} N, {:.3g} ns a sample\n",
           arguments.out, result.samples, result.samples == 1 ? "" : "s", result.paths, result.paths == 1 ? "" : "s",
           100 * static_cast<double>(result.in_contact) / samples, result.largest_force,
           1e9 * result.law_seconds / samples);
}

int run(const ExploreArguments& arguments, const CommonOptions& common) {
    constexpr int kMegabyte = 1000000;
    constexpr std::uint64_t kWorthWatching = 64; // MB: a second
    check(arguments, common);
    std::vector<std::string> warnings;
    CasePreparation preparation;
    const PreparedCase prepared = preparation.prepare(read_scene(arguments.scene, overrides(common), &warnings));
    print_warnings(warnings, common);
    if (prepared.images.mesh)
        print_warnings(warnings_of(prepared.one.scene.surface.mesh, *prepared.images.mesh, MeshUse::path), common);
    std::optional<Progress> bar;
    std::uint64_t megabytes = 0; // done
    const auto show = [&](std::uint64_t done, std::uint64_t total) {
        if (!bar)
            bar.emplace("MB", total / kMegabyte, common.quiet || total / kMegabyte < kWorthWatching);
        if (done / kMegabyte > std::exchange(megabytes, done / kMegabyte))
            bar->update(megabytes, "");
    };
    const ExploreResult result = explore(prepared, arguments.paths, std::filesystem::absolute(arguments.out), show);
    bar.reset();
    print_warnings(result.warnings, common);
    if (!common.quiet)
        print_outcome(result, arguments);
    if (common.json)
        print_data(as_json(result, arguments));
    if (result.unfinished > 0)
        throw Error(ExitCode::failed, fmt::format("{}: at {} of {} samples the proxy did not come to rest within its "
                                                  "limit of steps; their forces are not to be trusted",
                                                  arguments.out, result.unfinished, result.samples));
    return 0;
}

} // namespace

void add_explore_command(CLI::App& program, const CommonOptions& common, Command& chosen) {
    const auto arguments = std::make_shared<ExploreArguments>();
    CLI::App* command = program.add_subcommand("explore", "Take a probe along recorded paths and write what it feels");
    command->add_option("SCENE", arguments->scene, "scene file (TOML); needs no [grid]")->required();
    command
        ->add_option("--paths", arguments->paths,
                     "CSV file with a header and columns path, t, x, y, z (s, m); others are not read")
        ->required();
    command
        ->add_option("--out", arguments->out,
                     "CSV file: those columns, proxy gx, gy, gz (m), force fx, fy, fz (N), depth (m) and facet")
        ->required();
    command->callback([=, &common, &chosen] { chosen = [=, &common] { return run(*arguments, common); }; });
}

} // namespace forceshade
