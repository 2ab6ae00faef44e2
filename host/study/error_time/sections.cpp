// Errors on a section across the middle of a shape, and forces along a stroke there.
#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "host/study/error_time/error_time.h"

namespace forceshade::study::error_time {
namespace {

constexpr double kSectionAcross = 0.53; // of the box along y: no line of the own meshes' vertices lies there
constexpr std::size_t kFieldColumns = 50, kCellPlaces = 8, kFieldDepths = 6, kStrokeSteps = 160;
constexpr double kLeastError = 1e-4; // smaller errors are drawn here

double shortened(double value, int digits) {
    if (value == 0 || !std::isfinite(value))
        return value;
    const double unit = std::pow(10.0, std::floor(std::log10(std::fabs(value))) + 1 - digits);
    return unit < 1 ? std::round(value / unit) / std::round(1 / unit) : std::round(value / unit) * unit;
}

double stroke_depth(const Subject& subject) {
    return subject.scale.deepest / 4;
}

// A place of a section, and its position in the tables.
struct SectionPlace {
    TouchPlace place;
    glm::dvec3 truth{0};
    double x = 0, height = 0; /* mm: of the cell's middle, or of the step */
};

struct Section {
    std::vector<SectionPlace> field, stroke;
};

Section section_of(const Subject& subject) {
    Section section;
    const double y = subject.low.y + kSectionAcross * (subject.high.y - subject.low.y),
                 width = subject.high.x - subject.low.x;
    const PreparedCase& finest = *subject.variants.back().prepared;
    const auto add = [&](std::vector<SectionPlace>& to, const TouchPlace& surface, double x, double depth) {
        SectionPlace one{surface, {}, shortened(1e3 * x, 4), -shortened(1e3 * depth, 2)};
        one.place.depth = depth;
        one.place.at -= depth * surface.normal;
        one.truth = subject.force(one.place);
        if (one.truth != glm::dvec3(0))
            to.push_back(one);
    };
    for (std::size_t i = 0; i < kFieldColumns * kCellPlaces; ++i)
        if (const auto surface = surface_at(
                subject, finest, subject.low.x + (double(i) + 0.5) / (kFieldColumns * kCellPlaces) * width, y))
            for (std::size_t k = 0; k < kFieldDepths; ++k)
                add(section.field, *surface, subject.low.x + (double(i / kCellPlaces) + 0.5) / kFieldColumns * width,
                    subject.scale.shallowest() *
                        std::pow(subject.scale.deepest / subject.scale.shallowest(), double(k) / (kFieldDepths - 1)));
    for (std::size_t i = 0; i <= kStrokeSteps; ++i) {
        const double x = subject.low.x + double(i) / kStrokeSteps * width;
        if (const auto surface = surface_at(subject, finest, x, y))
            add(section.stroke, *surface, x, stroke_depth(subject));
    }
    return section;
}

// A grid's forces anywhere are those of the same law, one place after the other.
std::vector<glm::dvec3> forces_of(const Method& method, const std::vector<SectionPlace>& at) {
    std::vector<TouchPlace> places;
    for (const SectionPlace& one : at)
        places.push_back(one.place);
    if (!method.places)
        return method.forces(places);
    return method.precision == "f32" ? forces_by(StaticForce<float>(*method.variant->prepared), places)
                                     : forces_by(StaticForce<double>(*method.variant->prepared), places);
}

struct FieldRow {
    const Method* method;
    double x, height, error;
};

struct StrokeRow {
    std::string surface, method;
    const char* component;
    double x, force;
};

// The largest error of each cell.
void add_field(std::vector<FieldRow>& rows, const Method& method, const std::vector<SectionPlace>& at) {
    const std::vector<glm::dvec3> forces = forces_of(method, at);
    std::map<std::pair<double, double>, double> cells;
    for (std::size_t i = 0; i < at.size(); ++i) {
        double& cell = cells.try_emplace({at[i].x, at[i].height}, kLeastError).first->second;
        cell = std::max(cell, reference::length(forces[i] - at[i].truth) / reference::length(at[i].truth));
    }
    for (const auto& [place, error] : cells)
        rows.push_back({&method, place.first, place.second, shortened(error, 2)});
}

void add_stroke(std::vector<StrokeRow>& rows, const std::string& surface, const std::string& method,
                const std::vector<SectionPlace>& at, const std::vector<glm::dvec3>& forces) {
    for (const auto& [component, axis] : {std::pair("along x", 0), {"along z", 2}})
        for (std::size_t i = 0; i < at.size(); ++i)
            rows.push_back({surface, method, component, at[i].x, shortened(forces[i][axis], 3)});
}

} // namespace

std::vector<Table> section_tables(std::span<const Method* const> methods) {
    std::map<const Subject*, Section> sections;
    std::vector<FieldRow> fields;
    std::vector<StrokeRow> strokes;
    for (const Method* method : methods) {
        const Subject& subject = *method->subject;
        auto found = sections.find(&subject);
        if (found == sections.end()) {
            found = sections.emplace(&subject, section_of(subject)).first;
            std::vector<glm::dvec3> truth;
            for (const SectionPlace& one : found->second.stroke)
                truth.push_back(one.truth);
            add_stroke(strokes, subject.name, subject.against, found->second.stroke, truth);
        }
        add_field(fields, *method, found->second.field);
        add_stroke(strokes, subject.name, method->name, found->second.stroke, forces_of(*method, found->second.stroke));
    }
    return {table_of<FieldRow>(
                "fields", "Errors of the fronts' methods on a section",
                {{"way", "", "as in ways", [](const FieldRow& r) { return r.method->name; }},
                 {"surface", "", "as in ways", [](const FieldRow& r) { return r.method->subject->name; }},
                 {"x_mm", "mm", "middle of the cell", &FieldRow::x},
                 {"height_mm", "mm", "over the surface along its normal", &FieldRow::height},
                 {"local_max_1", "1", "largest of eight errors over the true force there; 1e-4 where it is less",
                  &FieldRow::error}},
                fields),
            table_of<StrokeRow>("strokes", "Force along a stroke, of the fronts' methods and of the truth",
                                {{"way", "", "as in ways, or their reference", &StrokeRow::method},
                                 {"surface", "", "as in ways", &StrokeRow::surface},
                                 {"component", "", "of the force", &StrokeRow::component},
                                 {"x_mm", "mm", "of the surface above the place", &StrokeRow::x},
                                 {"force_N", "N", "of that component", &StrokeRow::force}},
                                strokes)};
}

std::vector<Figure> section_figures(const Subject& subject, const Method& method) {
    const Where where{{"surface", subject.name}, {"way", method.name}};
    Figure field = make_figure(
        "field-" + subject.name, fmt::format("Error on a section: {}", method.name),
        "Largest error of eight places in each cell of a section, over the force there; at least 1e-4.",
        FigureKind::cells, "fields", where, {"x_mm", "x / mm"}, {"height_mm", "height over the surface / mm"}, "", "",
        {.value = "local_max_1",
         .value_label = "error over the force there",
         .value_logarithmic = true,
         .value_limit = 1});
    Figure stroke = make_figure("stroke-" + subject.name, fmt::format("Force along a stroke: {}", method.name),
                                fmt::format("Force {:.2g} mm under the surface, along the section; dashed: {}.",
                                            1e3 * stroke_depth(subject), subject.against),
                                FigureKind::scatter, "strokes", where, {"x_mm", "x / mm"}, {"force_N", "force / N"},
                                "component", "", {.joined = true});
    for (const char* component : {"along x", "along z"})
        stroke.curves.push_back({"strokes",
                                 {{"surface", subject.name}, {"way", subject.against}, {"component", component}},
                                 "x_mm",
                                 "force_N",
                                 fmt::format("{}, {}", component, subject.against),
                                 true});
    return {field, stroke};
}

} // namespace forceshade::study::error_time
