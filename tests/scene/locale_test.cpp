// A locale with a decimal comma and grouped digits changes nothing.
#include "host/scene/schema.h"
#include "host/scene/schema_json.h"
#include "host/scene/study.h"
#include "host/scene/value.h"

#include "tests/io/locales.h"
#include "tests/scene/errors.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace forceshade {
namespace {

struct Outcome {
    std::string study, schema, error, warning;
    double length;
    friend bool operator==(const Outcome&, const Outcome&) = default;
};

Outcome outcome() {
    const Study study = parse_study(
        "[surface]\nradius = [\"1234.5 mm\", \"15.24 mm\"]\n[grid]\nspacing = \"0.1 nm\"\nsize = [100000, 2, 2]\n"
        "origin = [\"1234.5 m\", \"0 m\", \"0 m\"]\n",
        "f.toml");
    return {study.cases.at(0).name + resolved_toml(study) + resolved_toml(study.cases.at(1)),
            schema_text() + schema_json().dump(),
            test::study_error("[surface]\nradius = 0.5\n") + test::study_error("[surface]\nwidth = \"1234.5 m\"\n"),
            study.warnings.at(0), parse_quantity("1234.5 mm", Dimension::length)};
}

TEST(Locale, WithCommasChangesNothing) {
    const Outcome expected = outcome();
    EXPECT_EQ(expected.length, 1.2345);
    testing::in_locales_with_commas([&] { EXPECT_EQ(outcome(), expected); });
}

} // namespace
} // namespace forceshade
