// A locale with a decimal comma and grouped digits changes nothing.
#include "host/scene/schema.h"
#include "host/scene/schema_json.h"
#include "host/scene/study.h"
#include "host/scene/value.h"

#include "tests/scene/errors.h"

#include <clocale>
#include <locale>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace forceshade {
namespace {

class GermanNumbers : public std::numpunct<char> {
protected:
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
};

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

TEST(Locale, AGlobalLocaleWithCommasChangesNothing) {
    const Outcome expected = outcome();
    const std::locale previous = std::locale::global(std::locale(std::locale::classic(), new GermanNumbers));
    const Outcome found = outcome();
    std::locale::global(previous);
    EXPECT_EQ(found, expected);
    EXPECT_EQ(found.length, 1.2345);
}

TEST(Locale, GermanChangesNothing) {
    const Outcome expected = outcome();
    const char* name = std::setlocale(LC_ALL, "de_DE.UTF-8");
    if (!name)
        GTEST_SKIP() << "this system has no locale de_DE.UTF-8";
    const Outcome found = outcome();
    std::setlocale(LC_ALL, "C");
    EXPECT_EQ(found, expected);
}

} // namespace
} // namespace forceshade
