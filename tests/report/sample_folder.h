// Results folders for the report to read, made without a device.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "host/output/record.h"

namespace forceshade::testing {

struct SampleCase {
    std::string name = "bump_shading-none";
    std::array<std::uint64_t, 3> size{24, 6, 16};
    bool alike_in_y = false;
    double strength = 1;                         /* N */
    bool noise = false;                          /* forces that no compression makes small */
    double first_y = -0.0025, y_spacing = 0.001; /* m */
    std::string scene{};                         /* as TOML; empty: the file names none */
    bool compared = false;                       /* errors: 2 deg more a sample along x, -0.25 N, in contact */
    bool paths = false;                          /* two paths beside it, the second one shorter */
};

/// Writes the case's volume; its record as a sweep would keep it.
CaseRecord write_sample_case(const std::filesystem::path& folder, const SampleCase& one);

/// manifest.json of those cases.
void write_sample_manifest(const std::filesystem::path& folder, const std::vector<CaseRecord>& records);

/// Two cases that differ in shading, and their manifest.
std::vector<CaseRecord> write_sample_sweep(const std::filesystem::path& folder);

/// The sample study with its files, as the program writes them; of a scene (resolved TOML), or of its own.
void write_sample_study(const std::filesystem::path& folder, const std::string& scene = {});

} // namespace forceshade::testing
