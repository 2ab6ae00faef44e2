#include "host/cli/live_files.h"

#include <cerrno>
#include <string_view>
#include <utility>
#include <vector>

#include <unistd.h>

#include <fmt/format.h>

#include "host/io/file_error.h"

namespace forceshade {

std::filesystem::path live_report_stem(const std::string& report, const std::string& name) {
    if (!report.empty())
        return std::filesystem::absolute(report);
    if (name.empty())
        return {};
    const std::filesystem::path log = std::filesystem::absolute(name);
    std::error_code ignored;
    if (std::filesystem::exists(log, ignored) && !std::filesystem::is_regular_file(log, ignored))
        return {}; // beside /dev/null there is no place for it
    return log.parent_path() / (log.stem().string() + ".live");
}

void check_live_outputs(const LiveFiles& files, const Scene& scene) {
    std::vector<std::filesystem::path> inputs{files.scene, scene.surface.map.path, scene.surface.mesh.path};
    if (scene.texture)
        inputs.emplace_back(scene.texture->map.path);
    if (scene.paths)
        inputs.emplace_back(scene.paths->path);
    if (constexpr std::string_view kReplay = "replay:"; files.device.starts_with(kReplay))
        inputs.emplace_back(files.device.substr(kReplay.size()));
    std::vector<std::pair<std::string, std::filesystem::path>> outputs{{"--log " + files.log, files.log}};
    for (const char* const ending : {".txt", ".json", ".png"})
        if (!files.report.empty())
            outputs.emplace_back("the report's " + files.report.filename().string() + ending,
                                 std::filesystem::path(files.report) += ending);
    std::error_code ignored;
    if (!files.log.empty() && std::filesystem::is_directory(files.log, ignored))
        throw UsageError(fmt::format("--log {}: is a folder; say the name of a CSV file in it", files.log));
    if (const std::string ending = std::filesystem::path(files.log).extension().string();
        ending == ".exr" || ending == ".npy" || ending == ".json" || ending == ".png")
        throw UsageError(fmt::format(
            "--log {}: a log is a CSV file, so its name ends in .csv; explore makes an EXR of it", files.log));
    for (const auto& [name, output] : outputs)
        for (const std::filesystem::path& input : inputs)
            if (std::filesystem::equivalent(output, input, ignored))
                throw UsageError(
                    fmt::format("{} would replace {}, which is read; choose another name", name, input.string()));
    // Scenes that are taken up are kept beside the log: never in place of the one that is watched.
    const std::filesystem::path scene_file = std::filesystem::absolute(files.scene);
    const std::filesystem::path log = std::filesystem::absolute(files.log.empty() ? "." : files.log);
    if (scene_file.parent_path() == log.parent_path() &&
        scene_file.filename().string().starts_with(log.stem().string() + ".scene-"))
        throw UsageError(fmt::format("--log {}: {} may be one of the scenes that are kept beside it; choose another "
                                     "name",
                                     files.log, files.scene));
    if (!files.report.empty() && ::access(files.report.parent_path().c_str(), W_OK) != 0)
        throw file_error("write", files.report, errno);
}

} // namespace forceshade
