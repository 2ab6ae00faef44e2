#include "host/spelling.h"

#include <boost/locale/utf.hpp>

#include <algorithm>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace forceshade {

namespace {

// Beyond this no word was meant, and the table of distances stays small.
constexpr std::size_t kLongestWord = 64;

// How far a word may be from the one that was meant.
std::size_t limit_of(std::string_view word) {
    return std::max<std::size_t>(1, word.size() / 3);
}

} // namespace

std::string lower_case(std::string_view text) {
    std::string result(text);
    for (char& c : result)
        if (c >= 'A' && c <= 'Z')
            c = static_cast<char>(c - 'A' + 'a');
    return result;
}

std::size_t edit_distance(std::string_view first, std::string_view second) {
    const std::size_t columns = second.size() + 1;
    std::vector<std::size_t> table((first.size() + 1) * columns);
    const auto at = [&](std::size_t i, std::size_t j) -> std::size_t& { return table[i * columns + j]; };
    for (std::size_t i = 0; i <= first.size(); ++i)
        at(i, 0) = i;
    for (std::size_t j = 0; j <= second.size(); ++j)
        at(0, j) = j;
    for (std::size_t i = 1; i <= first.size(); ++i)
        for (std::size_t j = 1; j <= second.size(); ++j) {
            const std::size_t change = first[i - 1] == second[j - 1] ? 0 : 1;
            at(i, j) = std::min({at(i - 1, j) + 1, at(i, j - 1) + 1, at(i - 1, j - 1) + change});
            if (i > 1 && j > 1 && first[i - 1] == second[j - 2] && first[i - 2] == second[j - 1])
                at(i, j) = std::min(at(i, j), at(i - 2, j - 2) + 1);
        }
    return at(first.size(), second.size());
}

std::string_view nearest(std::string_view word, std::span<const std::string> candidates) {
    if (word.size() > kLongestWord)
        return {};
    const std::string lower = lower_case(word);
    const std::size_t limit = word.size() < 3 ? 0 : limit_of(word);
    std::string_view best;
    std::pair<std::size_t, std::size_t> best_distance{limit, kLongestWord + 1};
    for (const std::string& candidate : candidates) {
        const std::pair distance{edit_distance(lower, lower_case(candidate)), edit_distance(word, candidate)};
        if (distance.first <= limit && distance < best_distance) {
            best = candidate;
            best_distance = distance;
        }
    }
    return best;
}

std::string did_you_mean(std::string_view word, std::span<const std::string> candidates) {
    const std::string_view found = nearest(word, candidates);
    return found.empty() ? std::string() : fmt::format("; did you mean \"{}\"?", found);
}

std::string missing_file_advice(const std::filesystem::path& file, const std::filesystem::path& written) {
    constexpr std::size_t kMostNames = 10000;
    const std::filesystem::path folder = file.parent_path();
    std::error_code error;
    if (!folder.empty() && !std::filesystem::is_directory(folder, error))
        return fmt::format("; there is no folder {}", folder.string());
    std::vector<std::string> names;
    for (std::filesystem::directory_iterator entry(folder.empty() ? "." : folder, error), end;
         !error && entry != end && names.size() < kMostNames; entry.increment(error))
        if (entry->path().extension() == file.extension() || !entry->is_directory(error))
            names.push_back(entry->path().filename().string());
    std::ranges::sort(names); // a folder's order is none
    const std::filesystem::path meant = nearest(file.filename().string(), names);
    const std::string stem = file.stem().string(); // extensions are alike in most of a folder
    const bool alike = edit_distance(stem, meant.stem().string()) <= limit_of(stem);
    return meant.empty() || !alike ? "; check the name, relative to where it is written"
                                   : fmt::format("; did you mean \"{}\"?", (written.parent_path() / meant).string());
}

std::size_t character_length(std::string_view text) {
    namespace utf = boost::locale::utf;
    const char* at = text.data();
    const utf::code_point code = utf::utf_traits<char>::decode(at, text.data() + text.size());
    return code == utf::illegal || code == utf::incomplete ? 0 : static_cast<std::size_t>(at - text.data());
}

std::string printable(std::string_view text) {
    std::string result;
    while (!text.empty()) {
        const std::size_t length = character_length(text);
        const auto first = static_cast<unsigned char>(text.front());
        if (length == 1 && (first < 0x20 || first == 0x7F))
            result += ' ';
        else
            result += length == 0 ? "\xEF\xBF\xBD" : text.substr(0, length); // U+FFFD
        text.remove_prefix(std::max<std::size_t>(length, 1));
    }
    return result;
}

} // namespace forceshade
