// A folder that a test may fill, removed with all that is in it; files as text, texts as lines and cells, and what
// texts and errors say.
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

/// All bytes of a file; of one that is not there, none.
inline std::string read_text(const std::filesystem::path& path) {
    std::ostringstream bytes;
    bytes << std::ifstream(path, std::ios::binary).rdbuf();
    return bytes.str();
}

/// \throws std::runtime_error if the file cannot be written.
inline void write_text(const std::filesystem::path& path, const std::string& text) {
    std::ofstream file(path, std::ios::binary);
    if (!(file << text).flush())
        throw std::runtime_error("cannot write " + path.string());
}

inline std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);)
        lines.push_back(line);
    return lines;
}

/// Of a line of a CSV file; no cell holds a line's end.
inline std::vector<std::string> cells_of(const std::string& line) {
    std::vector<std::string> cells(1);
    bool quoted = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
        if (line[i] == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"')
            cells.back() += line[++i];
        else if (line[i] == '"')
            quoted = !quoted;
        else if (line[i] == ',' && !quoted)
            cells.emplace_back();
        else
            cells.back() += line[i];
    }
    return cells;
}

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
        write_text(path_ / name, bytes);
        return path_ / name;
    }
    std::string read(const std::string& name) const { return read_text(path_ / name); }
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
inline ::testing::AssertionResult says(std::string_view text, const std::vector<std::string>& words) {
    for (const std::string& word : words)
        if (text.find(word) == text.npos)
            return ::testing::AssertionFailure() << "no \"" << word << "\" in \"" << text << '"';
    return ::testing::AssertionSuccess() << '"' << text << '"';
}
template <typename... Words>::testing::AssertionResult says(std::string_view text, const Words&... words) {
    return says(text, std::vector<std::string>{std::string(words)...});
}

} // namespace forceshade::testing
