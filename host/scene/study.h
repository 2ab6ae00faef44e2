// Studies: TOML text to a checked list of resolved cases.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host/scene/scene.h"

namespace forceshade {

struct Document;

/// Reads what is in a document beside the study, such as [experiment]. What it throws is told with the other errors.
using ReadBeside = std::function<void(const Document&)>;

/// "surface.radius" or "run.precision", and its value as text, without quotes unless in a list. Replaces the key
/// everywhere.
using Override = std::pair<std::string, std::string>;

struct Setting {
    std::string_view table; // "surface"
    std::string_view name;  // "radius"
    std::string literal;    // as TOML: "\"600 mil\"", a file by its base name
};

struct Case {
    std::string name; // unique in its study, also without regard to upper and lower case; at most 150 characters of
                      // [A-Za-z0-9._+-]
    Scene scene;
    std::vector<std::pair<std::string, std::string>>
        varied;                    // what the name lists: ("kind", "bump"), ("radius", "600 mil"), ...
    std::vector<Setting> settings; // every key that applies, in the schema's order
    bool chooses_precision = true; // nothing names one, or run.precision = "auto"
    bool first_of_surface = true;  // none before it in its study has the same [surface] and [texture]
};

/// Changes a case's precision, and what its settings say of it.
void set_precision(Case& one, Precision precision);
/// The same for surface.inside = "auto", once the mesh is known.
void set_inside(Case& one, InsideTest inside);

/// Which cases of a study are wanted: those whose name a shell pattern matches, and of these every `count`-th from the
/// `index`-th on, counted from 1.
struct CaseChoice {
    std::string only = "*";
    std::size_t index = 1, count = 1;
};

struct Study {
    std::vector<Case> cases;  // in the order of the file's variants and axes, the last axis fastest; none twice
    std::size_t all = 0;      // how many the study has; `cases` may be some of them
    std::vector<Case> sample; // where they are, some that are spread over all
    std::vector<std::string> warnings; // `source:line:column: ...`
    std::shared_ptr<const Document> document;
};

struct SceneText {
    std::string text;
    std::string source;           // what errors call it
    std::filesystem::path folder; // that names of files are relative to
};

/// Whether a path stands for standard input: "-".
bool is_standard_input(const std::filesystem::path& path);

/// Reads a whole file, or standard input, which is read once and given again when it is asked for again.
/// Throws IoError if it cannot be read, UsageError for a mesh, an image or other data, and for a text without content:
/// each says what to do instead.
SceneText read_scene_text(const std::filesystem::path& path);

/// The most combinations that a study may have.
inline constexpr std::size_t kMostCases = 100000;

/// Reads and resolves a study; "-" is standard input, as for read_scene_text. Files that it names are neither opened
/// nor looked for. Throws IoError if it cannot be read, UsageError `file:line:column: message` for what is wrong in it:
/// all of it, a line for each error. Cases that are not chosen are named, but neither built nor checked.
Study read_study(const std::filesystem::path& path, std::span<const Override> overrides = {},
                 const ReadBeside& beside = {}, const CaseChoice& choice = {});

/// The same from text. `source` is what errors call it; file names are relative to `folder`.
Study parse_study(std::string_view text, const std::string& source, const std::filesystem::path& folder = {},
                  std::span<const Override> overrides = {}, const ReadBeside& beside = {},
                  const CaseChoice& choice = {});

/// One scene: as a study, but a sweep axis or a second variant is a UsageError that names it. Warnings are added to
/// `warnings`.
Case read_scene(const std::filesystem::path& path, std::span<const Override> overrides = {},
                std::vector<std::string>* warnings = nullptr);
Case parse_scene(std::string_view text, const std::string& source, const std::filesystem::path& folder = {},
                 std::span<const Override> overrides = {}, std::vector<std::string>* warnings = nullptr);

/// The scene that a file of results states; none if it states none, or one of another version of the program.
std::optional<Case> stated_scene(const std::string& text);

/// The paper's study: 7 bumps x 3 radii, and n = 4, 8, 16, 32, 64 shaded and unshaded; 51 cases.
Study default_study(std::span<const Override> overrides = {}, const CaseChoice& choice = {});
std::string_view default_study_toml();

/// A case as complete, canonical TOML: every key that applies, in the user's text; files by base name, with the scene's
/// sha256 where it is known. Reading it gives an equal scene.
std::string resolved_toml(const Case& one);

/// A study likewise, its axes and variants kept: reading it gives the same cases.
std::string resolved_toml(const Study& study);

} // namespace forceshade
