// Where this checkout and its build are. CMake says it to one source alone: the others compile to the same objects in
// every clone.
#pragma once

#include <string>

namespace forceshade {

/// The path of a file of this checkout ("tests/data/spot.obj"), or of all of it ("").
std::string in_source(const std::string& name);

/// The path of a file of this build ("forceshade").
std::string in_build(const std::string& name);

/// The path of a shared library of a test folder: ("e2e", "penalty").
inline std::string module_of(const std::string& folder, const std::string& name) {
    return in_build("tests/" + folder + "/lib" + name + ".so");
}

} // namespace forceshade
