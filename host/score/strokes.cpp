#include "host/score/strokes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glm/geometric.hpp>

#include "host/error.h"
#include "host/scene/value.h"
#include "host/spelling.h"
#include "host/text.h"

namespace forceshade::score {
namespace {

constexpr double kRegular = 0.01;      // of the period
constexpr double kSamePlace = 1e-6;    // m
constexpr double kSlow = 0.02;         // s: no haptic loop samples so seldom
constexpr double kFarAway = 30;        // times the scene's size: beyond, the unit is another
constexpr std::size_t kMostNamed = 12; // columns in an error

struct Quantity {
    const char* name;
    std::optional<Dimension> dimension;
    std::vector<const char*> also; // names that other programs use
};

const std::vector<Quantity>& quantities() {
    static const std::vector<Quantity> all{
        {"path", std::nullopt, {"stroke", "trial"}},
        {"t", Dimension::time, {"time", "timestamp"}},
        {"x", Dimension::length, {"px", "pos_x", "position_x", "position.x", "probe_x"}},
        {"y", Dimension::length, {"py", "pos_y", "position_y", "position.y", "probe_y"}},
        {"z", Dimension::length, {"pz", "pos_z", "position_z", "position.z", "probe_z"}},
        {"fx", Dimension::force, {"force_x", "force.x", "f_x"}},
        {"fy", Dimension::force, {"force_y", "force.y", "f_y"}},
        {"fz", Dimension::force, {"force_z", "force.z", "f_z"}},
    };
    return all;
}

const Quantity* quantity_named(std::string_view name) {
    for (const Quantity& one : quantities())
        if (one.name == name)
            return &one;
    return nullptr;
}

double unit_of(const Quantity& quantity, const std::string& unit, const std::string& where) {
    if (!quantity.dimension)
        throw UsageError("{}: {} has no unit", where, quantity.name);
    try {
        return parse_quantity("1 " + unit, *quantity.dimension);
    } catch (const UsageError& error) {
        throw UsageError("{}: the unit of {}: {}", where, quantity.name, error.what());
    }
}

// "x_mm", "x [mm]", "x (mm)" as "x" and "mm".
std::pair<std::string, std::string> name_and_unit(const std::string& column) {
    for (const char* const marks : {"[]", "()"})
        if (const std::size_t at = column.find(marks[0]); at != std::string::npos && column.back() == marks[1])
            return {std::string(trimmed(std::string_view(column).substr(0, at))),
                    column.substr(at + 1, column.size() - at - 2)};
    for (const char* const unit : {"mm", "cm", "um", "m", "ms", "us", "s", "mN", "N"})
        if (const std::string end = std::string("_") + unit; column.size() > end.size() && column.ends_with(end))
            return {column.substr(0, column.size() - end.size()), unit};
    return {column, ""};
}

// The values of a quantity in SI units, by the map or by name; empty: the table has none.
class Columns {
public:
    Columns(const NumberTable& table, const ColumnMap& map) : table_(table), map_(map) {}

    std::vector<double> of(const char* name) const {
        const Quantity& quantity = *quantity_named(name);
        if (const auto mapped = map_.find(name); mapped != map_.end()) {
            for (auto at = table_.columns.begin(); at != table_.columns.end(); ++at) {
                const auto [own, unit] = name_and_unit(*at);
                if (*at != mapped->second.column && own != mapped->second.column)
                    continue;
                mapped->second.found = true;
                const double factor = mapped->second.unit                   ? *mapped->second.unit
                                      : quantity.dimension && !unit.empty() ? unit_of(quantity, unit, table_.source)
                                                                            : 1;
                return scaled(quantity, at, factor * (mapped->second.negative ? -1 : 1));
            }
            for (std::size_t i = 0; i < table_.columns.size(); ++i) // by its number, though it has a name
                if (mapped->second.column == fmt::format("#{}", i + 1)) {
                    mapped->second.found = true;
                    return scaled(quantity, table_.columns.begin() + std::ptrdiff_t(i),
                                  mapped->second.unit.value_or(1) * (mapped->second.negative ? -1 : 1));
                }
        }
        std::vector<std::string> names{quantity.name};
        names.insert(names.end(), quantity.also.begin(), quantity.also.end());
        for (const std::string& wanted : names)
            for (auto at = table_.columns.begin(); at != table_.columns.end(); ++at) {
                const auto [own, unit] = name_and_unit(*at);
                if (*at == wanted)
                    return scaled(quantity, at, 1);
                if (own == wanted && quantity.dimension && !unit.empty())
                    return scaled(quantity, at, unit_of(quantity, unit, table_.source));
            }
        return {};
    }

    // Three columns; all NaN-free. Empty if there is none of them and `optional`.
    std::vector<glm::dvec3> vectors(const std::array<const char*, 3>& names, bool optional) const {
        if (optional && std::ranges::any_of(names, [&](const char* name) { return of(name).empty(); }))
            return {};
        std::array<std::vector<double>, 3> parts;
        std::vector<const char*> missing;
        for (std::size_t axis = 0; axis < 3; ++axis)
            if (parts[axis] = of(names[axis]); parts[axis].empty())
                missing.push_back(names[axis]);
        if (!missing.empty())
            refuse(missing);
        std::vector<glm::dvec3> all(table_.rows());
        for (std::size_t row = 0; row < all.size(); ++row)
            all[row] = {parts[0][row], parts[1][row], parts[2][row]};
        return all;
    }

    // The table's columns, for errors.
    std::string shown() const {
        std::vector<std::string> names = table_.columns;
        if (names.size() > kMostNamed) {
            names.resize(kMostNamed);
            names.push_back("...");
        }
        return fmt::format("{}", fmt::join(names, ", "));
    }

private:
    std::vector<double> scaled(const Quantity& quantity, std::vector<std::string>::const_iterator column,
                               double factor) const {
        const auto at = static_cast<std::size_t>(column - table_.columns.begin());
        if (const auto [one, is_new] = taken_.try_emplace(at, &quantity); !is_new && one->second != &quantity)
            throw UsageError("{}: column {} would be both {} and {}; say with --map which column each is",
                             table_.source, *column, one->second->name, quantity.name);
        if (at < table_.words.size() && !table_.words[at].empty())
            throw UsageError("{}:{} in column {} is no number; a cell that is missing is empty or nan", table_.source,
                             table_.words[at], *column);
        std::vector<double> values = table_.cells[at];
        for (double& value : values)
            value *= factor;
        return values;
    }

    [[noreturn]] void refuse(const std::vector<const char*>& names) const {
        const char* const unit = quantity_named(names.front())->dimension == Dimension::force ? "mN" : "mm";
        std::vector<std::string> wrong, maps;
        for (const char* name : names) {
            maps.push_back(fmt::format("{}=COLUMN {}", name, unit));
            if (const auto mapped = map_.find(name); mapped != map_.end())
                wrong.push_back(
                    fmt::format("--map names a column for {} that is not there ({})", name, mapped->second.column));
        }
        if (wrong.empty())
            wrong.push_back(fmt::format("no column is called {}", fmt::join(names, ", ")));
        throw UsageError("{}: {}; the columns are {}. Say which they are, and in which unit: --map \"{}\"",
                         table_.source, fmt::join(wrong, ", "), shown(), fmt::join(maps, ", "));
    }

    const NumberTable& table_;
    const ColumnMap& map_;
    mutable std::map<std::size_t, const Quantity*> taken_; // of each column: what it is
};

constexpr std::array<const char*, 3> kPlace{"x", "y", "z"}, kForce{"fx", "fy", "fz"};

// The rows of each path, numbered in the order of their first samples. Without a column for it all are one.
std::vector<std::vector<std::size_t>> rows_by_path(const NumberTable& table, const std::vector<double>& path,
                                                   std::vector<std::uint64_t>& ids) {
    std::vector<std::vector<std::size_t>> all;
    std::unordered_map<std::uint64_t, std::size_t> numbers;
    for (std::size_t row = 0; row < table.rows(); ++row) {
        const double id = path.empty() ? 0 : path[row];
        if (!(id >= 0 && id < 0x1p53 && id == std::floor(id)))
            throw UsageError("{}:{}: path: {} is not a whole number from 0", table.source, table.lines[row], id);
        const auto [at, is_new] = numbers.try_emplace(static_cast<std::uint64_t>(id), all.size());
        if (is_new) {
            all.emplace_back();
            ids.push_back(static_cast<std::uint64_t>(id));
        }
        all[at->second].push_back(row);
    }
    return all;
}

} // namespace

void check_reach(const std::string& source, const std::vector<glm::dvec3>& places, double size,
                 const std::string& remedy) {
    double farthest = 0;
    for (const glm::dvec3& place : places)
        farthest = std::max({farthest, std::abs(place.x), std::abs(place.y), std::abs(place.z)});
    if (farthest > kFarAway * size)
        throw UsageError("{}: positions reach {:.3g} m, the scene {:.2g} m. {}", source, farthest, size, remedy);
}

ColumnMap parse_map(const std::string& text) {
    ColumnMap map;
    std::string_view rest = text;
    while (!rest.empty()) {
        std::size_t comma = 0;
        for (bool quoted = false; comma < rest.size() && (quoted || rest[comma] != ','); ++comma)
            quoted = quoted != (rest[comma] == '\'');
        const std::string one(trimmed(rest.substr(0, comma)));
        rest.remove_prefix(std::min(comma + 1, rest.size()));
        const std::size_t equals = one.find('=');
        const std::string name(trimmed(std::string_view(one).substr(0, equals)));
        const Quantity* const quantity = quantity_named(name);
        if (equals == std::string::npos || quantity == nullptr) {
            std::vector<std::string> names;
            for (const Quantity& known : quantities())
                names.emplace_back(known.name);
            throw UsageError(
                "--map: \"{}\": write QUANTITY=COLUMN UNIT, such as \"x=px mm, z=-py mm\"; quantities are {}", one,
                fmt::join(names, ", "));
        }
        std::string column(trimmed(std::string_view(one).substr(equals + 1)));
        ColumnSource source;
        if (source.negative = column.starts_with('-'); source.negative)
            column = std::string(trimmed(std::string_view(column).substr(1)));
        if (const std::size_t quote = column.rfind('\''); column.starts_with('\'') && quote > 0) {
            if (const std::string unit(trimmed(std::string_view(column).substr(quote + 1))); !unit.empty())
                source.unit = unit_of(*quantity, unit, "--map");
            column = column.substr(1, quote - 1);
        } else if (const std::size_t blank = column.find_last_of(' '); blank != std::string::npos) {
            source.unit = unit_of(*quantity, column.substr(blank + 1), "--map");
            column = std::string(trimmed(std::string_view(column).substr(0, blank)));
        }
        if (column.empty())
            throw UsageError("--map: \"{}\" names no column", one);
        source.column = column;
        if (!map.emplace(name, source).second)
            throw UsageError("--map: {} is named twice", name);
    }
    return map;
}

void require_found(const ColumnMap& map) {
    for (const auto& [name, source] : map)
        if (!source.found)
            throw UsageError("--map: no file has a column {} for {}", source.column, name);
}

std::size_t Strokes::samples() const {
    std::size_t count = 0;
    for (const Stroke& stroke : all)
        count += stroke.probe.size();
    return count;
}

Strokes read_strokes(const std::filesystem::path& file, const ColumnMap& map, std::optional<double> rate, double size) {
    const NumberTable table = read_numbers(file);
    const Columns columns(table, map);
    const std::vector<glm::dvec3> places = columns.vectors(kPlace, false);
    std::vector<double> times = columns.of("t");
    if (times.empty() && !rate)
        throw UsageError("{}: no column is called t; the columns are {}. Say which it is, --map \"t=COLUMN ms\", or "
                         "how often samples were taken, --rate \"1 kHz\"",
                         table.source, columns.shown());
    if (!times.empty() && rate)
        throw UsageError("{}: --rate is of files without times, and this one has them; leave --rate out", table.source);
    for (std::size_t row = 0; row < table.rows(); ++row)
        if (!is_finite(places[row]) || (!times.empty() && !std::isfinite(times[row])))
            throw UsageError("{}:{}: a position or time is missing or not finite; every sample needs x, y, z and t",
                             table.source, table.lines[row]);
    check_reach(
        table.source, places, size,
        "If the file is in mm, say so: --map \"x=x mm, y=y mm, z=z mm\", with the file's own names of the columns");

    Strokes strokes;
    strokes.source = table.source;
    std::vector<std::uint64_t> ids;
    const std::vector<std::vector<std::size_t>> paths = rows_by_path(table, columns.of("path"), ids);
    double period = 0;
    bool regular = true;
    for (std::size_t path = 0; path < paths.size(); ++path) {
        Stroke& stroke = strokes.all.emplace_back();
        stroke.id = ids[path];
        for (const std::size_t row : paths[path]) {
            const double time = times.empty() ? double(stroke.time.size()) / *rate : times[row];
            if (!stroke.time.empty()) {
                const double step = time - stroke.time.back();
                if (!(step > 0))
                    throw UsageError("{}:{}: t: {} s comes after {} s on path {}: times of a path must increase",
                                     table.source, table.lines[row], time, stroke.time.back(), stroke.id);
                if (period == 0)
                    period = step;
                if (regular && std::abs(step - period) > kRegular * period) {
                    regular = false;
                    strokes.warnings.push_back(fmt::format("{}:{}: {:.4g} s after the sample before, {:.4g} s at "
                                                           "first: with gaps there is no spectrum and no delay",
                                                           table.source, table.lines[row], step, period));
                }
            }
            stroke.time.push_back(time);
            stroke.probe.push_back(places[row]);
            stroke.lines.push_back(table.lines[row]);
            stroke.rows.push_back(static_cast<std::uint32_t>(row));
        }
    }
    if (regular && period > 0)
        strokes.period = period;
    if (period > kSlow)
        strokes.warnings.push_back(fmt::format(
            "{}: samples are {:.3g} s apart; are times in another unit? --map \"t=COLUMN ms\"", table.source, period));
    return strokes;
}

Track read_forces(const std::filesystem::path& file, const ColumnMap& map, const Strokes& strokes) {
    const NumberTable table = read_numbers(file);
    const Columns columns(table, map);
    const std::vector<glm::dvec3> forces = columns.vectors(kForce, false), places = columns.vectors(kPlace, true);
    std::vector<double> path = columns.of("path");
    if (table.rows() != strokes.samples())
        throw UsageError("{}: {} samples, {} has {}; a renderer's forces belong to the same samples, in the same order",
                         table.source, table.rows(), strokes.source, strokes.samples());
    std::unordered_map<std::uint64_t, std::vector<std::size_t>> rows; // of each path
    if (path.empty()) {                                               // in the strokes' own order
        for (const Stroke& stroke : strokes.all)
            rows[stroke.id].assign(stroke.rows.begin(), stroke.rows.end());
    } else {
        std::vector<std::uint64_t> ids;
        std::vector<std::vector<std::size_t>> found = rows_by_path(table, path, ids);
        for (std::size_t i = 0; i < ids.size(); ++i)
            rows[ids[i]] = std::move(found[i]);
    }
    Track track;
    for (const Stroke& stroke : strokes.all) {
        const std::vector<std::size_t>& of_path = rows[stroke.id];
        if (of_path.size() != stroke.probe.size())
            throw UsageError("{}: path {} has {} samples there and {} in {}", table.source, stroke.id, of_path.size(),
                             stroke.probe.size(), strokes.source);
        std::vector<glm::dvec3>& own = track.emplace_back();
        for (const std::size_t row : of_path) {
            const glm::dvec3& probe = stroke.probe[own.size()];
            if (!places.empty() && !(glm::length(places[row] - probe) <= kSamePlace))
                throw UsageError(
                    "{}:{}: the probe is at ({:.6g}, {:.6g}, {:.6g}) m, in {} at ({:.6g}, {:.6g}, {:.6g}) m: forces "
                    "belong to the same positions; are columns or units exchanged? --map says which they are",
                    table.source, table.lines[row], places[row].x, places[row].y, places[row].z, strokes.source,
                    probe.x, probe.y, probe.z);
            own.push_back(forces[row]);
        }
    }
    return track;
}

} // namespace forceshade::score
