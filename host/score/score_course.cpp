// Scores over the scenes of a course.
#include <algorithm>

#include <fmt/format.h>

#include "host/numbers.h"
#include "host/output/files.h"
#include "host/score/course.h"
#include "host/score/score.h"

namespace forceshade::score {
namespace {

UpdateTimes over_runs(const std::vector<UpdateTimes>& all) {
    const auto values = [&](double UpdateTimes::*of) {
        std::vector<double> found;
        for (const UpdateTimes& one : all)
            if (std::isfinite(one.*of))
                found.push_back(one.*of);
        return found;
    };
    const auto median = [&](double UpdateTimes::*of) {
        const std::vector<double> found = values(of);
        return found.empty() ? NAN : study::quantile(found, 0.5);
    };
    const auto largest = [&](double UpdateTimes::*of) {
        const std::vector<double> found = values(of);
        return found.empty() ? NAN : *std::ranges::max_element(found);
    };
    using T = UpdateTimes;
    return {median(&T::warm),   median(&T::median), largest(&T::p999),
            largest(&T::worst), median(&T::cold),   median(&T::boundary)};
}

// The scenes in which there is this renderer, and its row in each.
std::vector<std::pair<const SceneScores*, const Scored*>> rows_of(const std::vector<SceneScores>& scenes,
                                                                  const std::string& name) {
    std::vector<std::pair<const SceneScores*, const Scored*>> rows;
    for (const SceneScores& scene : scenes)
        for (const Scored& one : scene.scores.all)
            if (one.name == name)
                rows.emplace_back(&scene, &one);
    return rows;
}

Scored over_scenes(const std::vector<SceneScores>& scenes, const std::string& name) {
    Scored all;
    all.name = name;
    std::vector<UpdateTimes> times;
    std::string failed;
    std::size_t failures = 0;
    for (const auto& [scene, one] : rows_of(scenes, name)) {
        all.kind = one->kind;
        if (!one->failed.empty() && failures++ == 0)
            failed = fmt::format("{}: {}", scene->name, one->failed);
        all.strokes.insert(all.strokes.end(), one->strokes.begin(), one->strokes.end());
        all.track.insert(all.track.end(), one->track.begin(), one->track.end());
        if (one->times)
            times.push_back(*one->times);
    }
    if (failures > 0) {
        all.failed =
            failures == 1 ? failed : fmt::format("{}; and in {} more", failed, numbers::counted(failures - 1, "scene"));
        all.strokes.clear();
        all.track.clear();
    } else if (!times.empty()) {
        all.times = over_runs(times);
    }
    return all;
}

} // namespace

std::pair<Scores, Strokes> over_scenes(const std::vector<SceneScores>& scenes) {
    Scores scores;
    Strokes strokes;
    for (const SceneScores& scene : scenes) {
        for (const std::string& warning : scene.scores.warnings)
            scores.warnings.push_back(fmt::format("{}: {}", scene.name, warning));
        for (Stroke stroke : scene.strokes.all) {
            stroke.scene = scene.name;
            strokes.all.push_back(std::move(stroke));
        }
    }
    // Only what is in every scene can be compared over all of them.
    for (const Scored& one : scenes.front().scores.all)
        if (rows_of(scenes, one.name).size() == scenes.size())
            scores.all.push_back(over_scenes(scenes, one.name));
    return {std::move(scores), std::move(strokes)};
}

std::string scenes_text(const std::vector<SceneScores>& scenes) {
    std::vector<std::string> names;
    std::size_t width = 5;
    for (const SceneScores& scene : scenes) {
        width = std::max(width, scene.name.size());
        for (const Scored& one : scene.scores.all)
            if (one.kind != "oracle" && std::ranges::count(names, one.name) == 0)
                names.push_back(one.name);
    }
    std::string text = fmt::format("\nerror, % RMS, median over the strokes of a scene\n{:<{}}", "scene", width);
    for (const std::string& name : names)
        text += fmt::format("  {:>9}", name);
    text += "\n";
    for (const SceneScores& scene : scenes) {
        text += fmt::format("{:<{}}", scene.name, width);
        for (const std::string& name : names) {
            const auto one = std::ranges::find(scene.scores.all, name, &Scored::name);
            const double error = one == scene.scores.all.end() || !one->failed.empty()
                                     ? NAN
                                     : over_strokes(*one, &StrokeScore::error_share);
            text += fmt::format("  {:>{}}", std::isfinite(error) ? fmt::format("{:.3g}", error) : "-",
                                std::max<std::size_t>(9, name.size()));
        }
        text += "\n";
    }
    return text;
}

std::string course_note(const std::filesystem::path& folder) {
    const std::filesystem::path sums = folder / "SHA256SUMS";
    const std::string name = fmt::format("version {} of the standard course", kCourseVersion);
    if (!std::filesystem::exists(sums) || sha256_of_file(sums) != kCourseDigest)
        return fmt::format("{} is not {}: scores on it cannot be compared with others' on that.", folder.string(),
                           name);
    const auto other = [&](const std::filesystem::path& file) {
        return fmt::format("{} is not {}: {} is another file; scores on it cannot be compared with others' on that.",
                           folder.string(), name, file.string());
    };
    const std::string text = read_file(sums);
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (const std::string own = entry.path().filename().string();
            own.ends_with(".toml") && text.find("  " + own + "\n") == text.npos)
            return other(entry.path());
    for (std::string_view rest = text; !rest.empty();
         rest.remove_prefix(std::min(rest.find('\n'), rest.size() - 1) + 1)) {
        const std::string_view line = rest.substr(0, rest.find('\n'));
        constexpr std::size_t kDigits = 64; // then two blanks
        if (line.size() <= kDigits + 2)
            continue;
        const std::filesystem::path file = folder / line.substr(kDigits + 2);
        if (!std::filesystem::exists(file) || sha256_of_file(file) != line.substr(0, kDigits))
            return other(file);
    }
    return fmt::format("{} is {}, SHA-256 of its SHA256SUMS: {}.", folder.string(), name, kCourseDigest);
}

} // namespace forceshade::score
