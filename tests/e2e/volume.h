// Volumes read with OpenEXR alone, so that nothing of the program judges its own files.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace forceshade::testing {

struct ReadPart {
    int width = 0, height = 0;
    std::map<std::string, std::vector<float>> channels; // by name, row by row; UINT and HALF converted
    std::map<std::string, std::string> types;           // "float", "half" or "uint" by channel
};

struct ReadVolume {
    std::map<std::string, ReadPart> parts;    // by name
    std::map<std::string, std::string> texts; // string attributes of the first part
    std::array<int, 3> grid{};                // forceshade.grid
    std::array<double, 3> origin{}, spacing{};
};

/// All pixels and attributes. \throws std::exception if the file does not open or is not complete.
ReadVolume read_exr(const std::filesystem::path& path);

} // namespace forceshade::testing
