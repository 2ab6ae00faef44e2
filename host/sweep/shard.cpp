#include "host/sweep/shard.h"

#include <charconv>
#include <cstdlib>
#include <string_view>

#include <fmt/format.h>

#include "host/error.h"

namespace forceshade {
namespace {

std::optional<std::size_t> whole_number(std::string_view text) {
    std::size_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size())
        return std::nullopt;
    return value;
}

std::size_t slurm_number(const char* name, std::optional<std::size_t> otherwise = std::nullopt) {
    const char* text = std::getenv(name);
    const std::optional<std::size_t> value = text ? whole_number(text) : otherwise;
    if (!value)
        throw UsageError(fmt::format("this is a task of a Slurm array, and {} is {}: say --shard I/N (1/1: everything)",
                                     name, text ? fmt::format("\"{}\"", text) : "not set"));
    return *value;
}

} // namespace

Shard parse_shard(const std::string& text) {
    const std::size_t slash = text.find('/');
    if (slash != std::string::npos) {
        const auto index = whole_number(std::string_view(text).substr(0, slash));
        const auto total = whole_number(std::string_view(text).substr(slash + 1));
        if (index && total && *index >= 1 && *index <= *total)
            return {*index, *total};
    }
    throw UsageError(fmt::format("--shard {}: it is I/N with 1 <= I <= N, for example 3/8", text));
}

std::optional<Shard> slurm_shard() {
    if (!std::getenv("SLURM_ARRAY_TASK_ID"))
        return std::nullopt;
    const std::size_t id = slurm_number("SLURM_ARRAY_TASK_ID"), total = slurm_number("SLURM_ARRAY_TASK_COUNT");
    const std::size_t first = slurm_number("SLURM_ARRAY_TASK_MIN", 0), step = slurm_number("SLURM_ARRAY_TASK_STEP", 1);
    if (id < first || step == 0 || (id - first) / step >= total)
        throw UsageError(fmt::format("this is task {} of a Slurm array of {} tasks from {} by {}, which cannot be: say "
                                     "--shard I/N (1/1: everything)",
                                     id, total, first, step));
    return Shard{(id - first) / step + 1, total};
}

} // namespace forceshade
