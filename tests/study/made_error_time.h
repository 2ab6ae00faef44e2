// A study of error against time as it might have come out, for tests of its findings.
#pragma once

#include <stdexcept>
#include <string>

#include "host/study/error_time/error_time_findings.h"
#include "host/study/error_time/measured.h"

namespace forceshade::study::error_time {

/// A contender has a time in the unit and a direction error, deg.
class Made {
public:
    Measured measured;

    Made() {
        add("bump, 4 facets, flat", "direct", "f64", 0.8, 8, 4, "none");
        add("bump, 64 facets, flat", "direct", "f64", 1, 0.5, 64, "none");
        add("bump, 64 facets, flat", "direct", "f32", 0.7, 0.5, 64, "none");
        add("bump, 64 facets, flat", "direct", "f32, half output", 1.5, 0.51, 64, "none");
        add("bump, 1 facet, shaded", "direct", "f64", 0.6, 0, 1, "reference");
        add("bump, 64 facets, flat", "field, kernel", "f32", 0.2, 0.5, 64, "none");
        add("bump, 64 facets, flat", "field, CPU on one thread", "f32", 0.4, 0.5, 64, "none");
        add("bump, 64 facets, flat", "closed loop, CPU on one thread", "f64", 4, 0.5, 64, "none");
        add("bump, 64 facets, flat", "closed loop, CPU on one thread", "f32", 3, 0.5, 64, "none");
        add("mesh, 8 x 8 cells, none", "direct", "f64", 10, 4, {}, "none");
        add("mesh, 8 x 8 cells, none", "god-object", "f64", 5, 4.1, {}, "none");
        add("mesh, 8 x 8 cells, none", "look-up, trilinear", "f32", 0.5, 4.2, {}, "none");
        add("mesh, 8 x 8 cells, none", "look-up, tricubic", "f32", 1.5, 4.15, {}, "none");
        of("look-up, trilinear", "f32").spacing = of("look-up, tricubic", "f32").spacing = 0.2e-3;
        measured.series = {{"patch of triangles, mean_value", "e", "1 / cells", {0.1, 0.05}, {4, 1}, 2, "L7"},
                           {"mesh, mean_value, static", "e", "1 / cells", {0.1, 0.05}, {4, 2}, 1, "depth"}};
        for (const double spacing : {0.4e-3, 0.2e-3})
            for (const char* place : {"smooth", "edge"})
                measured.lookups.push_back({"a bump",
                                            spacing,
                                            {"trilinear", place, 500, place[0] == 'e' ? spacing / 0.04 : 1e-4, 1, 1},
                                            place[0] == 'e' ? std::optional(1.0) : std::nullopt});
        measured.patches = {{"cylinder", "triangles", "none", 8, {2.12, 3.77, 7.42}, {2.12, 3.77, 7.42}}};
        measured.unit = 1;
    }

    void add(const std::string& law, const std::string& family, const std::string& precision, double time, double angle,
             std::optional<double> facets, const std::string& shading) {
        Contender one;
        one.name = law + ": " + family + " " + precision;
        one.subject = law.substr(0, law.find(','));
        one.family = family;
        one.precision = precision;
        one.shading = shading;
        one.facets = facets;
        one.reference = law + ": direct f64";
        measured.contenders.push_back(one);
        ForceErrors errors;
        errors.direction = Summary{angle, 2 * angle, 3 * angle};
        errors.vector = Summary{angle / 57, angle / 30, angle / 20};
        errors.compared = 100;
        ForceErrors exact;
        exact.direction = Summary{0, 0, 0};
        exact.vector = Summary{precision == "f64" ? 0 : 1e-7, 1e-6, precision == "f64" ? 0 : 1e-5};
        measured.compared.push_back({errors, exact});
        times.push_back(time);
    }

    Contender& of(const std::string& family, const std::string& precision) {
        for (Contender& one : measured.contenders)
            if (one.family == family && one.precision == precision)
                return one;
        throw std::out_of_range(family);
    }

    std::size_t number(const std::string& name) const {
        for (std::size_t i = 0; i < measured.contenders.size(); ++i)
            if (measured.contenders[i].name == name)
                return i;
        throw std::out_of_range(name);
    }

    StudyData data() {
        measured.rounds = {{1, times}, {2, times}};
        measured.rounds[1].unit = apart ? 1 : 2;
        for (double& seconds : measured.rounds[1].seconds)
            seconds *= 2;
        StudyData data;
        data.study = "error-time";
        data.device = "a device";
        data.cores = 2;
        data.tables = tables_of(measured);
        return data;
    }

    std::string text(const std::string& name) {
        for (const Finding& one : error_time_findings(data()))
            if (one.name == name)
                return one.text;
        return "";
    }

    std::vector<double> times;
    bool apart = false; // the second round's ratios are twice the first's
};

inline bool says(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

} // namespace forceshade::study::error_time
