#include "tests/e2e/workplace.h"

#include <algorithm>

#include <sys/stat.h>

namespace forceshade::testing {
namespace {

// Removed when the tests end.
const Folder& cache() {
    static const Folder folder;
    return folder;
}

} // namespace

const char* const kThreeCases = R"([surface]
radius = ["600 mil", "1000 mil", "1400 mil"]
facets = 3
[force]
shading = "reference"
[grid]
size = [16, 4, 8]
origin = ["-14 mm", "-1 mm", "-4 mm"]
spacing = ["1.8 mm", "0.5 mm", "0.6 mm"]
)";

const char* const kOneCase = R"([surface]
facets = 3
[force]
shading = "reference"
[grid]
size = [16, 4, 8]
origin = ["-14 mm", "-1 mm", "-4 mm"]
spacing = ["1.8 mm", "0.5 mm", "0.6 mm"]
)";

Tree tree_of(const std::filesystem::path& folder) {
    Tree tree;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
        if (!entry.is_directory())
            tree[entry.path().lexically_relative(folder).string()] = read_text(entry.path());
    return tree;
}

Tree results_in(const std::filesystem::path& folder) {
    Tree tree = tree_of(folder);
    // These tell times.
    std::erase_if(tree, [](const auto& file) {
        return file.first.starts_with("manifest") || file.first.starts_with('.') || file.first == "report.html";
    });
    return tree;
}

std::set<std::string> differences(const Tree& a, const Tree& b) {
    std::set<std::string> names;
    const auto note_missing = [&](const Tree& from, const Tree& in) {
        for (const auto& [name, content] : from)
            if (const auto found = in.find(name); found == in.end() || found->second != content)
                names.insert(name);
    };
    note_missing(a, b);
    note_missing(b, a);
    return names;
}

std::vector<std::string> temporaries_in(const std::filesystem::path& folder) {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
        if (entry.path().filename().string().front() == '.')
            names.push_back(entry.path().filename().string());
    return names;
}

std::string last_line(const std::string& text) {
    const std::string whole = text.substr(0, text.find_last_not_of('\n') + 1);
    return whole.substr(whole.rfind('\n') + 1);
}

std::string small_study(const std::string& grid) {
    static const std::string built_in = run({.arguments = {"schema", "--default-study"}}).out;
    const std::size_t table = built_in.find("[grid]\n"), end = built_in.find("\n[", table + 1);
    if (end == std::string::npos)
        throw std::runtime_error("the built-in study has no [grid] before its variants");
    return built_in.substr(0, table) + "[grid]\n" + grid + built_in.substr(end);
}

Workplace::Workplace() {
    // Open to the users that some tests become.
    ::chmod(folder_.path().c_str(), 0755);
}

Launch Workplace::launch(std::vector<std::string> arguments) const {
    Launch launch;
    launch.arguments = std::move(arguments);
    // Most tests write the same file again and again.
    if (!launch.arguments.empty() && (launch.arguments[0] == "field" || launch.arguments[0] == "explore") &&
        std::find(launch.arguments.begin(), launch.arguments.end(), "--no-clobber") == launch.arguments.end())
        launch.arguments.insert(launch.arguments.begin() + 1, "--overwrite");
    launch.folder = folder_.path();
    launch.environment["XDG_CACHE_HOME"] = cache().path().string();
    return launch;
}

Launch Workplace::without_device(std::vector<std::string> arguments) const {
    Launch launch = this->launch(std::move(arguments));
    for (const char* name : {"VK_ICD_FILENAMES", "VK_DRIVER_FILES"})
        launch.environment[name] = "/nonexistent/icd.json";
    return launch;
}

Outcome Workplace::expect_success(std::vector<std::string> arguments) const {
    const Outcome outcome = forceshade(std::move(arguments));
    EXPECT_EQ(outcome.code, 0) << outcome.error;
    return outcome;
}

void Workplace::expect_failure(int code, std::vector<std::string> arguments,
                               const std::vector<std::string>& words) const {
    expect_failure(code, launch(std::move(arguments)), words);
}

void Workplace::expect_failure(int code, const Launch& launch, const std::vector<std::string>& words) {
    const Outcome outcome = run(launch);
    EXPECT_EQ(outcome.code, code) << outcome.error;
    EXPECT_EQ(outcome.out, "");
    EXPECT_TRUE(says(outcome.error, words));
}

void Workplace::expect_refused(const Launch& launch, const std::vector<std::string>& words, int code) const {
    const Tree before = tree_of(folder_.path());
    const std::vector<std::string> names = folder_.names(); // empty folders, too
    expect_failure(code, launch, words);
    EXPECT_EQ(differences(before, tree_of(folder_.path())), std::set<std::string>{});
    EXPECT_EQ(folder_.names(), names);
}

nlohmann::json Workplace::read_json(const std::string& name) const {
    return nlohmann::json::parse(read_text(path(name)));
}

} // namespace forceshade::testing
