// Looks again and again into the folder of a sweep that runs: nothing half-written may ever carry a final name.
#pragma once

#include <filesystem>
#include <set>
#include <string>

#include "tests/e2e/workplace.h"

namespace forceshade::testing {

class FolderWatch {
public:
    /// `expected`: what results_in(folder) is in the end.
    FolderWatch(std::filesystem::path folder, const Tree& expected) : folder_(std::move(folder)), expected_(expected) {}

    /// Checks every file with a final name that was not found whole before, or changed since it was looked at; a file
    /// that vanishes meanwhile is none.
    void look();

    /// How many results were found whole.
    std::size_t whole() const { return whole_.size(); }

private:
    void check(const std::string& name, const std::string& content);

    std::filesystem::path folder_;
    const Tree& expected_;
    std::set<std::string> whole_;
    std::map<std::string, std::pair<std::filesystem::file_time_type, std::uintmax_t>>
        seen_; // time and bytes of the others
};

} // namespace forceshade::testing
