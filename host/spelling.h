// Text that others wrote: made printable; and the word, or the file, that was meant where one is misspelt.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace forceshade {

/// Length in bytes of the valid UTF-8 character that `text` begins with, or 0.
std::size_t character_length(std::string_view text);

/// Valid UTF-8 on one line: bad bytes become U+FFFD, control characters a space.
std::string printable(std::string_view text);

/// Of ASCII; other bytes stay as they are.
std::string lower_case(std::string_view text);

/// Damerau-Levenshtein distance (optimal string alignment): insertions, deletions, changes and swaps of neighbours, in
/// bytes.
std::size_t edit_distance(std::string_view first, std::string_view second);

/// The candidate nearest to `word`, upper and lower case counting least; empty if none is near enough to be meant.
std::string_view nearest(std::string_view word, std::span<const std::string> candidates);

/// `; did you mean "stiffness"?`, or an empty text if nothing is near.
std::string did_you_mean(std::string_view word, std::span<const std::string> candidates);

/// For a file that is missing: `; did you mean "bump.toml"?` with the nearest name in its folder, or what to check.
/// `written`: the file as the user wrote it.
std::string missing_file_advice(const std::filesystem::path& file, const std::filesystem::path& written);
inline std::string missing_file_advice(const std::filesystem::path& file) {
    return missing_file_advice(file, file);
}

} // namespace forceshade
