// Which part of a study this process does.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace forceshade {

struct Shard {
    std::size_t index = 1, count = 1; /* 1-based: "3/8" */
};

/// \throws UsageError unless the text is I/N with 1 <= I <= N.
Shard parse_shard(const std::string& text);

/// The shard that Slurm's array variables name, if they are set. \throws UsageError if they make no sense: a task that
/// then took the whole study would do the others' work too.
std::optional<Shard> slurm_shard();

} // namespace forceshade
