// The message of the UsageError that a call throws.
#pragma once

#include "host/error.h"
#include "host/scene/study.h"

#include <string>
#include <string_view>

namespace forceshade::test {

template <typename Call> std::string usage_error(Call&& call) {
    try {
        call();
    } catch (const UsageError& error) {
        return error.what();
    }
    return "(no error)";
}

inline std::string study_error(std::string_view text) {
    return usage_error([&] { parse_study(text, "f.toml"); });
}

} // namespace forceshade::test
