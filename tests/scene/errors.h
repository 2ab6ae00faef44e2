// The message of the UsageError that a call throws, and where a text has its error.
#pragma once

#include "host/error.h"
#include "host/scene/study.h"
#include "tests/io/folder.h"

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace forceshade::test {

template <typename Call> std::string usage_error(Call&& call) {
    const std::string message = testing::message_of<UsageError>(call);
    return message.empty() ? "(no error)" : message;
}

inline std::string study_error(std::string_view text) {
    return usage_error([&] { parse_study(text, "f.toml"); });
}

/// Texts, and line and column of the one error that each has; nothing: it has none.
inline void expect_places(const std::vector<std::pair<std::string, std::string>>& rows) {
    for (const auto& [text, place] : rows) {
        const std::string error = study_error(text);
        EXPECT_TRUE(place.empty() ? error == "(no error)" : error.starts_with("f.toml:" + place + ":"))
            << text << "not at " << place << ": " << error;
    }
}

} // namespace forceshade::test
