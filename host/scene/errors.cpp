#include "host/scene/errors.h"

#include <algorithm>
#include <set>

namespace forceshade {

namespace {

std::vector<FileError::One> sorted(std::vector<FileError::One> all) {
    // At one place in the order in which they were found.
    std::set<FileError::One> seen;
    std::erase_if(all, [&](const FileError::One& one) { return !seen.insert(one).second; });
    std::ranges::stable_sort(all, {}, &FileError::One::where);
    return all;
}

std::string text_of(const std::vector<FileError::One>& all) {
    if (all.size() == 1)
        return location_prefix(all.front().source, all.front().where) + all.front().message;
    std::string text;
    for (std::size_t i = 0; i < std::min(all.size(), kMostErrors); ++i)
        text += location_prefix(all[i].source, all[i].where) + all[i].message + '\n';
    // Those of overrides come first and name what was overridden.
    return text + fmt::format("{}{} errors in {}{}", all.size(), all.size() < kEnoughErrors ? "" : " or more",
                              all.back().source,
                              all.size() > kMostErrors ? fmt::format(", the first {} are listed", kMostErrors) : "");
}

} // namespace

std::string location_prefix(std::string_view source, Location location) {
    return location.line == 0 ? fmt::format("{}: ", source)
                              : fmt::format("{}:{}:{}: ", source, location.line, location.column);
}

FileError::FileError(std::vector<One> all) : UsageError(text_of(sorted(all))), all_(sorted(std::move(all))) {}

void fail(std::string_view source, Location location, const std::string& message) {
    throw FileError({{location, std::string(source), message}});
}

} // namespace forceshade
