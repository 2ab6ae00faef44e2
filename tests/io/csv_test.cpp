#include "host/output/raw_formats.h"

#include <clocale>

#include <gtest/gtest.h>

namespace forceshade {
namespace {

TEST(Csv, quotes_what_needs_it_and_prints_numbers_exactly) {
    std::setlocale(LC_ALL, "de_DE.UTF-8"); // changes nothing where it is installed
    CsvText csv;
    csv.add("plain").add("a,b").add("say \"x\"").add("two\nlines").add("").add(" a b\t").end();
    csv.add(0.1).add(0.1f).add(1e300).add(-0.0).add(3u).add(std::uint64_t{18446744073709551615u}).end();
    std::setlocale(LC_ALL, "C");
    EXPECT_EQ(csv.text(), "plain,\"a,b\",\"say \"\"x\"\"\",\"two\nlines\",,\" a b\t\"\n"
                          "0.1,0.1,1e+300,-0,3,18446744073709551615\n");
}

} // namespace
} // namespace forceshade
