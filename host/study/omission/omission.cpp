#include "host/study/omission/omission.h"

#include <fmt/format.h>

#include "host/error.h"
#include "host/study/omission/measurement.h"

namespace forceshade::study {
namespace {

constexpr Rounds kFull{15, 0.1, 6}, kQuick{9, 0.02, 1};

// A scene whose samples are all free has nothing that matters: that leaving it out changes nothing would be said of
// nothing, and all times would be those of free space.
void require_contact(const BaseScene& base, const Touched& samples) {
    if (samples.field == 0 && samples.paths == 0)
        throw UsageError(fmt::format("nothing of the scene's {} is in contact: everything could be left out, and the "
                                     "study would compare zeros with zeros; let it reach below the surface",
                                     !base.paths  ? "[grid]"
                                     : base.field ? "[grid] and [paths]"
                                                  : "[paths]"));
}

// Where the grid touches nothing but the paths do, or the other way round.
void add_free_note(const BaseScene& base, const Touched& samples, StudyData& data) {
    const auto add = [&](const char* what) {
        data.notes.push_back(fmt::format("Nothing of the scene's {} is in contact: what is told of it is what free "
                                         "space takes, and that it stays free.",
                                         what));
    };
    if (base.field && samples.field == 0)
        add("[grid]");
    if (base.paths && samples.paths == 0)
        add("[paths]");
}

void add_notes(const std::vector<BaseScene>& scenes, const Rounds& rounds, StudyData& data) {
    for (const BaseScene& base : scenes) {
        const auto& size = base.prepared.one.scene.grid.size;
        data.notes.push_back(
            base.field ? fmt::format("{}: {}, {} x {} x {} voxels.", base.name, base.about, size[0], size[1], size[2])
                       : fmt::format("{}: {}.", base.name, base.about));
    }
    data.notes.push_back(
        fmt::format("Each ratio is of {} paired rounds, fewer where they take long; in each both sides were evaluated "
                    "in turn, each "
                    "first as often, again and again where that takes but a moment, and the least times count.",
                    rounds.count));
    data.notes.push_back("Every y and free space are always left out where a scene permits; the study alone evaluates "
                         "them. What makes a field depend on y (proxies) is switched at every y on both sides.");
}

} // namespace

StudyData study_omission(StudyRun& run) {
    const Rounds rounds = run.options().quick ? kQuick : kFull;
    const std::vector<BaseScene> scenes =
        run.scene() ? std::vector{user_scene(*run.scene(), run.options().quick)} : own_scenes(run.options().quick);
    Touched samples;
    std::vector<Measurement> rows;
    std::vector<Part> parts;
    if (run.scene())
        parts.push_back({"contact", [&] {
                             samples = touched(run.engine(), scenes.front());
                             require_contact(scenes.front(), samples);
                         }});
    for (const BaseScene& base : scenes)
        for (Comparison& one : comparisons_of(base, !run.options().engine.cpu))
            parts.push_back({fmt::format("{}: {}", one.scene, one.feature), [&run, &rows, rounds, one] {
                                 rows.push_back(measure(run.engine(), one, rounds, run.options().folder));
                             }});
    run.run(parts);
    StudyData data = run.data();
    add_omissions(data, scenes, rows);
    add_notes(scenes, rounds, data);
    if (run.scene())
        add_free_note(scenes.front(), samples, data);
    return data;
}

} // namespace forceshade::study
