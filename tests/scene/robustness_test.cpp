// Whatever the text, only the errors of the outside world come out, and each says where.
#include "host/scene/study.h"

#include "host/error.h"
#include "host/scene/schema.h"
#include "tests/scene/errors.h"
#include "tests/scene/random_study.h"

#include <gtest/gtest.h>

namespace forceshade {
namespace {

std::size_t random_place(const std::string& text) {
    return static_cast<std::size_t>(test::random_below(static_cast<int>(text.size()) + 1));
}

void mutate(std::string& text) {
    static const std::vector<std::string> kPieces{"[",
                                                  "]",
                                                  "{",
                                                  "}",
                                                  "\"",
                                                  "'",
                                                  "\"\"\"",
                                                  ".",
                                                  ",",
                                                  "=",
                                                  "\n",
                                                  "#",
                                                  "-",
                                                  "e9",
                                                  "0",
                                                  "9223372036854775807",
                                                  "1e308 m",
                                                  "nan",
                                                  "inf",
                                                  "\\u0000",
                                                  "\xff",
                                                  "\u00b5",
                                                  std::string(1, '\0'),
                                                  "[[variant]]\n",
                                                  "[texture]\n",
                                                  "surface.",
                                                  "0x1",
                                                  "1979-05-27"};
    const std::size_t at = random_place(text);
    switch (test::random_below(4)) {
    case 0:
        text.erase(at, static_cast<std::size_t>(test::random_below(8)));
        break;
    case 1:
        text.insert(at, kPieces[static_cast<std::size_t>(test::random_below(static_cast<int>(kPieces.size())))]);
        break;
    case 2:
        text.insert(at, text.substr(random_place(text), static_cast<std::size_t>(test::random_below(40))));
        break;
    default:
        if (at < text.size())
            text[at] = static_cast<char>(test::random_below(256));
    }
}

std::string random_text() {
    const int source = test::random_below(10);
    std::string text = source == 0   ? schema_text()
                       : source == 1 ? std::string(default_study_toml())
                                     : test::random_study();
    const int mutations = test::random_below(6);
    for (int i = 0; i < mutations; ++i)
        mutate(text);
    return text;
}

// Any other exception ends the test.
template <typename Call> void expect_usage_error(Call&& call, std::string_view beginning) {
    try {
        call();
    } catch (const UsageError& error) {
        RC_ASSERT(std::string_view(error.what()).starts_with(beginning));
    } catch (const IoError&) {
    }
}

TEST(Robustness, MutatedText) {
    EXPECT_TRUE(rc::check([] {
        const std::string text = random_text();
        RC_LOG() << text;
        expect_usage_error([&] { resolved_toml(parse_study(text, "f.toml")); }, "f.toml:");
        expect_usage_error([&] { parse_scene(text, "f.toml"); }, "f.toml:");
    }));
}

TEST(Robustness, MutatedOverrides) {
    EXPECT_TRUE(rc::check([] {
        auto overrides = test::random_overrides();
        for (auto& [path, text] : overrides)
            mutate(test::random_below(4) == 0 ? path : text);
        expect_usage_error([&] { parse_study("", "f.toml", {}, overrides); }, "");
    }));
}

TEST(Robustness, ArbitraryBytes) {
    EXPECT_TRUE(rc::check(
        [](const std::string& text) { expect_usage_error([&] { parse_study(text, "f.toml"); }, "f.toml:"); }));
}

TEST(Robustness, NestsAsDeepAsItMay) {
    // Inline tables as deep as the parser allows, each under a key of as many dots as are let through.
    std::string dots = "a";
    for (int i = 0; i < 32; ++i)
        dots += ".a";
    std::string text;
    for (int i = 0; i < 255; ++i)
        text += dots + " = { ";
    text += dots + " = 1" + std::string(255, '}') + "\n";
    const std::string message = test::study_error(text);
    EXPECT_NE(message.find("nested more than 16 deep"), std::string::npos) << message;
}

} // namespace
} // namespace forceshade
