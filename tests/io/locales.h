// Locales with a decimal comma and grouped digits, which must change nothing.
#pragma once

#include <clocale>
#include <locale>
#include <string>

namespace forceshade::testing {

/// Runs `check` while C++ has such a locale for all, then, where the system knows it, while C has the German one.
template <typename Check> void in_locales_with_commas(const Check& check) {
    struct Commas : std::numpunct<char> {
        char do_decimal_point() const override { return ','; }
        char do_thousands_sep() const override { return '.'; }
        std::string do_grouping() const override { return "\3"; }
    };
    const std::locale previous = std::locale::global(std::locale(std::locale::classic(), new Commas));
    check();
    std::locale::global(previous);
    if (std::setlocale(LC_ALL, "de_DE.UTF-8")) {
        check();
        std::setlocale(LC_ALL, "C");
    }
}

} // namespace forceshade::testing
