// A scratch folder in which the program is run, the studies that tests run there, and what it leaves.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/e2e/process.h"
#include "tests/io/folder.h"

namespace forceshade::testing {

/// Contents by path relative to a folder, folders left out.
using Tree = std::map<std::string, std::string>;

/// Everything below a folder.
Tree tree_of(const std::filesystem::path& folder);

/// Of a sweep's folder what is the same after every run: all but the manifest, its records and the report, which tell
/// times, and temporaries.
Tree results_in(const std::filesystem::path& folder);

/// The names in a and b that are not in both with the same bytes.
std::set<std::string> differences(const Tree& a, const Tree& b);

/// Names below a folder that begin with a dot.
std::vector<std::string> temporaries_in(const std::filesystem::path& folder);

/// The last line of a text, without its end.
std::string last_line(const std::string& text);

/// The paper's study as built in, on another grid (16 x 4 x 8 voxels).
std::string small_study(const std::string& grid = "size = [16, 4, 8]\norigin = [\"-14 mm\", \"-1 mm\", \"-4 mm\"]\n"
                                                  "spacing = [\"1.8 mm\", \"0.5 mm\", \"0.6 mm\"]\n");

/// Three cases on 16 x 4 x 8 voxels: radius 600, 1000 and 1400 mil.
extern const char* const kThreeCases;

/// One case on 16 x 4 x 8 voxels.
extern const char* const kOneCase;

class Workplace : public ::testing::Test {
protected:
    Workplace();

    /// The program in the folder; its compiled kernels are kept from test to test, away from the user's.
    Launch launch(std::vector<std::string> arguments) const;
    Outcome forceshade(std::vector<std::string> arguments) const { return run(launch(std::move(arguments))); }
    /// On a machine on which Vulkan finds no device.
    Launch without_device(std::vector<std::string> arguments) const;

    /// Runs a command that must succeed.
    Outcome expect_success(std::vector<std::string> arguments) const;
    /// What a command prints that must succeed and prints JSON.
    nlohmann::json json_of(std::vector<std::string> arguments) const {
        return nlohmann::json::parse(expect_success(std::move(arguments)).out);
    }

    /// Runs a command that must fail with a code and say all of `words` on stderr, in one message without abort.
    void expect_failure(int code, std::vector<std::string> arguments, const std::vector<std::string>& words) const;
    static void expect_failure(int code, const Launch& launch, const std::vector<std::string>& words);
    /// That, and that it changes no file of the folder.
    void expect_refused(const Launch& launch, const std::vector<std::string>& words, int code = 2) const;
    void expect_refused(std::vector<std::string> arguments, const std::vector<std::string>& words, int code = 2) const {
        expect_refused(launch(std::move(arguments)), words, code);
    }

    std::filesystem::path path(const std::string& name) const { return folder_ / name; }
    void write(const std::string& name, const std::string& text) const { write_text(path(name), text); }
    nlohmann::json read_json(const std::string& name) const;

    Folder folder_;
};

} // namespace forceshade::testing
