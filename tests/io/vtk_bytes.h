// Arrays of VTK's XML files, read by hand: VTK's file formats as its documentation describes them, and zlib.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include <gtest/gtest.h>
#include <zlib.h>

namespace forceshade::testing {

/// The bytes of the array of this name in a file's bytes; `type` and `components` must be its own.
inline std::string vtk_bytes(const std::string& file, const std::string& name, const std::string& type,
                             std::size_t components) {
    const std::string tag = "<DataArray type=\"" + type + "\" Name=\"" + name + "\" NumberOfComponents=\"" +
                            std::to_string(components) + "\" format=\"appended\" offset=\"";
    const std::size_t at = file.find(tag), data = file.find("encoding=\"raw\">\n_") + 17;
    if (at == std::string::npos) {
        ADD_FAILURE() << "no " << tag;
        return {};
    }
    std::size_t from = data + std::stoul(file.substr(at + tag.size(), 20));
    std::array<std::uint64_t, 3> counts{}; // blocks, bytes of one, of the last one if it is shorter
    std::memcpy(counts.data(), file.data() + from, sizeof counts);
    std::vector<std::uint64_t> packed(counts[0]);
    std::memcpy(packed.data(), file.data() + from + sizeof counts, 8 * packed.size());
    from += sizeof counts + 8 * packed.size();
    std::string unpacked;
    for (const std::uint64_t size : packed) {
        std::string block(counts[1], '\0');
        uLongf room = block.size();
        EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(block.data()), &room,
                             reinterpret_cast<const Bytef*>(file.data() + from), size),
                  Z_OK)
            << name;
        unpacked += block.substr(0, room);
        from += size;
    }
    EXPECT_EQ(unpacked.size() % counts[1], counts[2]) << name;
    return unpacked;
}

/// The numbers of the array of this name.
template <typename T>
std::vector<T> vtk_numbers(const std::string& file, const std::string& name, std::size_t components = 1) {
    const char* type = std::is_same_v<T, float>          ? "Float32"
                       : std::is_same_v<T, double>       ? "Float64"
                       : std::is_same_v<T, std::int32_t> ? "Int32"
                                                         : "Int64";
    const std::string bytes = vtk_bytes(file, name, type, components);
    std::vector<T> numbers(bytes.size() / sizeof(T));
    std::memcpy(numbers.data(), bytes.data(), numbers.size() * sizeof(T));
    return numbers;
}

} // namespace forceshade::testing
