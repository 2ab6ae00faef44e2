#include "host/study/error_time/contender.h"

#include <fmt/format.h>

namespace forceshade::study::error_time {

std::string contender_name(const Subject& subject, const Variant& variant, const std::string& way) {
    return fmt::format("{}, {}: {}", subject.name, variant.name, way);
}

std::string reference_name(const Subject& subject, const Variant& variant) {
    return contender_name(subject, variant, "direct f64");
}

Contender contender_of(const Subject& subject, const Variant& variant, const std::string& family,
                       const std::string& precision) {
    Contender contender;
    contender.name = contender_name(subject, variant, fmt::format("{} {}", family, precision));
    contender.subject = subject.name;
    contender.against = subject.against;
    contender.family = family;
    contender.shading = variant.shading;
    contender.precision = precision;
    contender.facets = variant.facets;
    contender.cells = variant.cells;
    contender.reference = reference_name(subject, variant);
    return contender;
}

void add_contenders(Contenders& contenders, const Subject& subject, const Extents& extents, Engine& engine) {
    for (const Variant& variant : subject.variants) {
        add_direct(contenders, subject, variant, extents);
        if (variant.kernels)
            add_grids(contenders, subject, variant, engine);
        if (variant.lookups)
            add_lookups(contenders, subject, variant, extents);
        if (variant.thorough)
            add_loops(contenders, subject, variant, engine);
    }
}

} // namespace forceshade::study::error_time
