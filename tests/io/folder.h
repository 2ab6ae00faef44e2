// A folder that a test may fill, removed with all that is in it; and what texts and errors say.
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <stdlib.h>

#include <gtest/gtest.h>

namespace forceshade::testing {

class Folder {
public:
    Folder() {
        std::string name = (std::filesystem::temp_directory_path() / "forceshade-test-XXXXXX").string();
        if (!::mkdtemp(name.data()))
            throw std::runtime_error("no folder for the test");
        path_ = name;
    }
    ~Folder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;

    const std::filesystem::path& path() const { return path_; }
    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
    std::filesystem::path write(const std::string& name, const std::string& bytes) const {
        std::ofstream(path_ / name, std::ios::binary) << bytes;
        return path_ / name;
    }
    std::string read(const std::string& name) const {
        std::ostringstream bytes;
        bytes << std::ifstream(path_ / name, std::ios::binary).rdbuf();
        return bytes.str();
    }
    std::vector<std::string> names() const {
        std::vector<std::string> names;
        for (const auto& entry : std::filesystem::directory_iterator(path_))
            names.push_back(entry.path().filename().string());
        std::ranges::sort(names);
        return names;
    }

private:
    std::filesystem::path path_;
};

/// The message of the exception that `work` throws, which must be of type E; empty if none.
template <typename E, typename Work> std::string message_of(Work&& work) {
    try {
        work();
    } catch (const E& error) {
        return error.what();
    }
    return {};
}

/// Whether all of these words are in a text.
template <typename... Words> inline ::testing::AssertionResult says(std::string_view text, const Words&... words) {
    for (const std::string_view word : {std::string_view(words)...})
        if (text.find(word) == text.npos)
            return ::testing::AssertionFailure() << "no \"" << word << "\" in \"" << text << '"';
    return ::testing::AssertionSuccess() << '"' << text << '"';
}

} // namespace forceshade::testing
