#include "tests/e2e/folder_watch.h"

#include <fstream>
#include <optional>
#include <sstream>
#include <utility>

namespace forceshade::testing {
namespace {

// Nothing if the file is gone: a directory is listed before its files are read.
std::optional<std::string> content_of(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file)
        return std::nullopt;
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

} // namespace

void FolderWatch::look() {
    std::error_code gone;
    for (std::filesystem::recursive_directory_iterator entry(folder_, gone), end; !gone && entry != end;
         entry.increment(gone)) {
        const std::string name = entry->path().lexically_relative(folder_).string();
        if (entry->path().filename().string().front() == '.' || whole_.count(name) || entry->is_directory(gone))
            continue;
        std::error_code vanished;
        const std::pair now{entry->last_write_time(vanished), entry->file_size(vanished)};
        if (vanished || std::exchange(seen_[name], now) == now)
            continue;
        if (const auto content = content_of(entry->path()))
            check(name, *content);
    }
}

void FolderWatch::check(const std::string& name, const std::string& content) {
    if (name.ends_with(".json")) {
        EXPECT_FALSE(nlohmann::json::parse(content, nullptr, false).is_discarded()) << name << ": " << content;
    } else if (name == "report.html") {
        EXPECT_TRUE(content.ends_with("</html>\n")); // it tells times
    } else if (name == "summary.csv") {
        EXPECT_TRUE(content.ends_with('\n')); // it grows from run to run
    } else if (const auto found = expected_.find(name); found == expected_.end()) {
        ADD_FAILURE() << name << " does not belong here";
    } else {
        EXPECT_TRUE(found->second == content) << name << " was half-written or wrong, with " << content.size() << " of "
                                              << found->second.size() << " bytes";
        whole_.insert(name);
    }
}

} // namespace forceshade::testing
