// XML as a strict parser sees it.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace forceshade::testing {

struct Element {
    std::string name;
    std::map<std::string, std::string> attributes;
    std::string text; /* directly within */
};

/// Every element in order of its start. \throws std::runtime_error that says where it is not well-formed.
std::vector<Element> elements_of(std::string_view xml);

} // namespace forceshade::testing
