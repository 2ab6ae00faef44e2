// Finds the word that somebody meant who misspelt one.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace forceshade {

/// Damerau-Levenshtein distance (optimal string alignment): insertions, deletions, changes and swaps of neighbours, in
/// bytes.
std::size_t edit_distance(std::string_view first, std::string_view second);

/// The candidate nearest to `word`, upper and lower case counting least; empty if none is near enough to be meant.
std::string_view nearest(std::string_view word, std::span<const std::string> candidates);

/// `; did you mean "stiffness"?`, or an empty text if nothing is near.
std::string did_you_mean(std::string_view word, std::span<const std::string> candidates);

} // namespace forceshade
