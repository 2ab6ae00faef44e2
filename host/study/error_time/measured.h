// Everything that was measured and computed, before it becomes tables.
#pragma once

#include <string>
#include <vector>

#include "host/study/data/study_data.h"
#include "host/study/error_time/contender.h"
#include "host/study/error_time/fits.h"
#include "host/study/error_time/force_errors.h"
#include "host/study/error_time/lookup_errors.h"
#include "host/study/error_time/rounds.h"

namespace forceshade::study::error_time {

/// A contender's errors; nothing where it has none.
struct Compared {
    std::optional<ForceErrors> smooth;    /* against what Contender::against names */
    std::optional<ForceErrors> reference; /* against reference<double> */
};

/// A row of the table of L7, and what the laws print of it.
struct PatchRow {
    std::string surface, cells_of, shading;
    unsigned cells = 0;
    std::array<double, 3> found{};                /* deg: RMS, largest, largest jump */
    std::array<std::optional<double>, 3> printed; /* deg */
};

/// The error at each of some sizes.
struct Series {
    std::string name, quantity;
    std::string size; /* what stands in sizes: "1 / facets", "1 / cells", "spacing / m" */
    std::vector<double> sizes, errors;
    std::optional<double> expected; /* order */
    std::string from;               /* who says so */
};

struct LookupRow {
    std::string surface;
    double spacing = 0; /* m */
    LookupError error;
    std::optional<double> expected;
};

struct Measured {
    Contenders contenders;
    std::size_t unit = 0; /* contender */
    std::vector<Compared> compared;
    std::vector<Round> rounds;
    std::vector<PatchRow> patches;
    std::vector<Series> series;
    std::vector<LookupRow> lookups;
};

/// Adds the series that follow from the contenders' errors: facets of a bump, cells of a mesh.
void add_series(Measured& measured);

nlohmann::ordered_json to_json(const std::vector<PatchRow>& rows);
std::vector<PatchRow> patch_rows_from(const nlohmann::ordered_json& json);
nlohmann::ordered_json to_json(const std::vector<LookupError>& errors);
std::vector<LookupError> lookup_errors_from(const nlohmann::ordered_json& json);

/// Every table that findings are read out of.
std::vector<Table> tables_of(const Measured& measured);
/// Those that show something: scatter of error over time, convergence, look-ups, precision.
std::vector<Figure> figures_of(const std::vector<Table>& tables);

} // namespace forceshade::study::error_time
