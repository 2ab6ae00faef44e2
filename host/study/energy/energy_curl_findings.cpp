#include "host/study/energy/energy_curl_findings.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace forceshade::study {
namespace {

struct Map {
    std::string name;
    double mean; /* of K */
};

struct Maps {
    std::vector<Map> curl, sampling; /* above what sampling leaves, and not; the least first */
    double off = -1;                 /* largest difference from a closed form, of K; below 0: there is none */
};

Maps maps_of(const Table& table, const std::vector<std::string>& conservative) {
    Maps maps;
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
        maps.off = std::max(maps.off, table.number(row, "closed_form_difference_per_K").value_or(-1));
        const auto mean = table.number(row, "mean_per_K");
        if (!mean)
            continue;
        const bool none = std::ranges::find(conservative, table.word(row, "scheme")) != conservative.end() ||
                          *mean <= table.number(row, "sampling_per_K").value_or(0);
        (none ? maps.sampling : maps.curl).push_back({table.word(row, "map"), *mean});
    }
    for (std::vector<Map>* some : {&maps.curl, &maps.sampling})
        std::ranges::stable_sort(*some, {}, &Map::mean);
    return maps;
}

std::string named(const Map& map) {
    return fmt::format("{} ({:.2g} K)", map.name, map.mean);
}

std::string sampling_text(const std::vector<Map>& sampling) {
    std::vector<std::string> names;
    for (const Map& map : sampling)
        names.push_back(map.name);
    return fmt::format("no more than sampling leaves, up to {:.1g} K, {} {}", sampling.back().mean,
                       names.size() > 1 ? "have" : "has", fmt::join(names, "; "));
}

} // namespace

void add_curl(const StudyData& data, const std::vector<std::string>& conservative, std::vector<Finding>& findings) {
    const Table* table = data.find("curl_maps");
    if (!table)
        return;
    const Maps maps = maps_of(*table, conservative);
    std::vector<std::string> parts;
    if (maps.curl.size() > 1)
        parts.push_back(
            fmt::format("the most has {}, the least {}", named(maps.curl.back()), named(maps.curl.front())));
    else if (!maps.curl.empty())
        parts.push_back(fmt::format("{} has some", named(maps.curl.front())));
    if (!maps.sampling.empty())
        parts.push_back(sampling_text(maps.sampling));
    if (parts.empty())
        return;
    if (maps.off >= 0)
        parts.push_back(fmt::format("that of the flat shaded plane is its closed form to {:.1g} K", maps.off));
    findings.push_back(
        {"curl", fmt::format("Of curl, the mean size over a section's cells in contact: {}.", fmt::join(parts, "; "))});
}

} // namespace forceshade::study
