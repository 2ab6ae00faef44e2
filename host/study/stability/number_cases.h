// Scenes at the rims of what numbers can hold: one parameter of a plain scene after the other, far out.
#pragma once

#include <string>
#include <vector>

#include "host/prepare/prepared_case.h"

namespace forceshade::study {

/// A field to be evaluated, and where its forces are known: the same voxel by voxel at the origin, if it is far away.
struct NumberField {
    PreparedCase prepared;
    std::optional<PreparedCase> home;
};

/// A surface with one parameter at one value.
struct NumberCase {
    std::string surface, axis;
    double value = 0;
    std::vector<NumberField> fields; /* their errors count together */
};

/// What is varied: its name, unit, where it stands in the plain scene, and what it means.
struct NumberAxis {
    std::string name, unit, label;
    double base; /* or where it is easiest: of penetration the deepest */
    std::string meaning;
};

const std::vector<NumberAxis>& number_axes();
const std::vector<std::string>& number_surfaces();

/// Of a surface along an axis, ascending; none where the axis means nothing there. \throws UsageError for a name that
/// is not there.
std::vector<double> number_values(const std::string& surface, const std::string& axis, bool quick);
NumberCase number_case(const std::string& surface, const std::string& axis, double value);

} // namespace forceshade::study
