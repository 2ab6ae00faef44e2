// Renderers scored along strokes: against the oracle, and against the smooth shape of the scene.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/field/prepared_case.h"
#include "host/renderer/renderer_process.h"
#include "host/score/measures.h"
#include "host/study/study_data.h"

namespace forceshade::score {

/// Times of a renderer's updates, s.
struct UpdateTimes {
    double warm = NAN;                            /* the mean in a second run along the strokes */
    double median = NAN, p999 = NAN, worst = NAN; /* in the first run */
    double cold = NAN;                            /* the median with caches full of other memory */
    double boundary = NAN;                        /* the median of what the way to its process and back takes */
};

/// A renderer and what came of it.
struct Scored {
    std::string name;
    std::string kind;                 /* "oracle", "forceshade", "renderer", "recorded" */
    Track track;                      /* empty: it failed */
    std::vector<StrokeScore> strokes; /* as many as there are strokes */
    std::optional<UpdateTimes> times; /* none: its forces are from a file */
    std::string failed;               /* what it did wrong; empty: nothing */
};

struct ScoreOptions {
    Strokes strokes;
    std::vector<RendererSource> renderers;
    std::vector<std::pair<std::string, Track>> recorded; /* by name */
    RendererPatience patience{};
};

struct Scores {
    std::vector<Scored> all;
    std::vector<std::string> warnings;
};

/// The oracle first, then this program's other laws of the scene, then renderers in their order. \throws UsageError for
/// a stroke that leaves the oracle's reach, Interrupted, IoError.
Scores score_all(const PreparedCase& prepared, const ScoreOptions& options);

/// The positions that a scene's paths prescribe. \throws UsageError for a scene without paths, or whose hand moves the
/// probe, so that positions depend on the forces.
Strokes scene_strokes(const PreparedCase& prepared);

/// m: a scene's size, against which a file's unit is held.
double size_of(const PreparedCase& prepared);

/// A stroke's measures by name, in their readers' units; NaN where there is nothing to measure.
std::vector<std::pair<std::string, double>> named_measures(const StrokeScore& score);

/// Scores of one scene of a course.
struct SceneScores {
    std::string name;
    Scores scores;
    Strokes strokes;
};

/// All scenes as one: the strokes of a renderer are those of all scenes; it has failed if it failed in one. Of times
/// the median over scenes, of p99.9 and worst the largest. Renderers that are not in every scene are left out.
std::pair<Scores, Strokes> over_scenes(const std::vector<SceneScores>& scenes);

/// Over the strokes of a renderer, in the measure's unit for readers: its median, largest or sum; NaN without one.
double over_strokes(const Scored& scored, double StrokeScore::*measure);

/// The errors of every renderer in every scene, for the terminal.
std::string scenes_text(const std::vector<SceneScores>& scenes);

/// Whether a folder is the standard course, unchanged, as a sentence.
std::string course_note(const std::filesystem::path& folder);

/// Tables, figures and findings of scores; of a course with those of each of its scenes.
void add_scores(study::StudyData& data, const Scores& scores, const Strokes& strokes,
                const std::vector<SceneScores>& scenes = {});

/// The scores as a table for the terminal.
std::string score_text(const Scores& scores);

} // namespace forceshade::score
