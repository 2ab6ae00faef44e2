// When a case's record counts as done: the same scene and files, the same program.
#pragma once

#include <map>
#include <set>
#include <string>

#include "host/scene/study.h"

namespace forceshade {

/// Of everything that decides the bytes of a case. `scene`: as resolved_toml() writes it, with the SHA-256 of its
/// files.
std::string fingerprint(const std::string& scene, bool cpu_engine);

/// For each case of a study that counts, the fingerprints of which its record must have one. Records of other scenes or
/// programs under the same name do not.
using Fingerprints = std::map<std::string, std::set<std::string>>;

/// Sets in the scenes of a study the SHA-256 of the files that they name, each read once, and returns what records
/// must say. Cases whose files cannot be read, or are not those that the scene means, are missing in the result.
Fingerprints identify(Study& study);

} // namespace forceshade
