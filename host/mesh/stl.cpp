// STL, text and binary: triangles without vertices of their own. Corners of the same coordinates become one vertex.

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cstring>
#include <vector>

#include <fmt/format.h>

#include "host/error.h"
#include "host/mesh/formats.h"

namespace forceshade::mesh_file {

namespace {

constexpr std::size_t kHeader = 84, kTriangle = 50; // bytes

std::uint32_t little_endian(const char* bytes) {
    std::uint32_t value = 0;
    for (int i = 3; i >= 0; --i)
        value = value << 8 | static_cast<unsigned char>(bytes[i]);
    return value;
}

std::uint64_t mixed(std::uint64_t x) {
    x = (x ^ (x >> 32)) * 0xD6E8FEB86659FD93u;
    return x ^ (x >> 29);
}

// The number of each distinct corner, by open addressing.
class Welder {
public:
    explicit Welder(PolygonSoup& soup) : soup_(soup), slots_(1024, kFree) {}

    std::uint32_t vertex_of(glm::dvec3 corner) {
        corner += 0.0; // -0 becomes 0
        if (soup_.vertices.size() * 2 > slots_.size())
            grow();
        std::uint32_t& slot = slots_[slot_of(corner)];
        if (slot == kFree) {
            slot = static_cast<std::uint32_t>(soup_.vertices.size());
            soup_.vertices.push_back(corner);
        }
        return slot;
    }

private:
    static constexpr std::uint32_t kFree = 0xFFFFFFFFu;

    // Compared bit for bit, so that a NaN is equal to itself.
    static std::array<std::uint64_t, 3> bits_of(const glm::dvec3& corner) {
        return {std::bit_cast<std::uint64_t>(corner.x), std::bit_cast<std::uint64_t>(corner.y),
                std::bit_cast<std::uint64_t>(corner.z)};
    }

    std::size_t slot_of(const glm::dvec3& corner) const {
        const auto bits = bits_of(corner);
        std::size_t slot = mixed(mixed(mixed(bits[0]) + bits[1]) + bits[2]) & (slots_.size() - 1);
        while (slots_[slot] != kFree && bits_of(soup_.vertices[slots_[slot]]) != bits)
            slot = (slot + 1) & (slots_.size() - 1);
        return slot;
    }

    void grow() {
        slots_.assign(slots_.size() * 4, kFree);
        for (std::size_t i = 0; i < soup_.vertices.size(); ++i)
            slots_[slot_of(soup_.vertices[i])] = static_cast<std::uint32_t>(i);
    }

    PolygonSoup& soup_;
    std::vector<std::uint32_t> slots_;
};

PolygonSoup read_binary(const Source& source) {
    if (!is_binary_stl(source.bytes)) {
        const std::size_t size = source.bytes.size();
        if (size < kHeader)
            throw IoError(fmt::format("{}: {} bytes are too few for an STL file, and it is no text; it is damaged or "
                                      "truncated",
                                      source.name, size));
        const std::uint64_t triangles = little_endian(source.bytes.data() + 80);
        throw IoError(fmt::format("{}: a binary STL file that announces {} triangles has {} bytes, but this one has "
                                  "{}; it is damaged or truncated",
                                  source.name, triangles, kHeader + kTriangle * triangles, size));
    }
    PolygonSoup soup;
    Welder welder(soup);
    const std::size_t triangles = (source.bytes.size() - kHeader) / kTriangle;
    soup.corners.reserve(3 * triangles);
    soup.begins.reserve(triangles + 1);
    for (std::size_t triangle = 0; triangle < triangles; ++triangle) {
        const char* at = source.bytes.data() + kHeader + kTriangle * triangle + 12; // behind the normal
        for (int corner = 0; corner < 3; ++corner, at += 12)
            soup.corners.push_back(
                welder.vertex_of({std::bit_cast<float>(little_endian(at)), std::bit_cast<float>(little_endian(at + 4)),
                                  std::bit_cast<float>(little_endian(at + 8))}));
        soup.begins.push_back(static_cast<std::uint32_t>(soup.corners.size()));
    }
    return soup;
}

bool is_keyword(std::string_view word, std::string_view keyword) {
    return std::equal(word.begin(), word.end(), keyword.begin(), keyword.end(),
                      [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b; });
}

class StlTextReader {
public:
    explicit StlTextReader(const Source& source) : lines_(source.name, source.bytes), welder_(soup_) {}

    PolygonSoup read() {
        while (next_word("solid", true)) {
            line_ = {}; // the name
            while (!is_keyword(peek("facet or endsolid"), "endsolid"))
                read_facet();
            line_ = {};
        }
        return std::move(soup_);
    }

private:
    void read_facet() {
        next_word("facet");
        next_word("normal");
        for (int axis = 0; axis < 3; ++axis) // what it says has no bearing, and often it is nan
            if (peek("a normal").empty() || take_word(line_).empty())
                lines_.damaged("a normal has three coordinates");
        next_word("outer");
        next_word("loop");
        for (int corner = 0; corner < 3; ++corner)
            read_vertex();
        next_word("endloop");
        next_word("endfacet");
        soup_.begins.push_back(static_cast<std::uint32_t>(soup_.corners.size()));
    }

    void read_vertex() {
        next_word("vertex");
        glm::dvec3 vertex;
        for (int axis = 0; axis < 3; ++axis) {
            peek("a coordinate");
            const std::string_view word = take_word(line_);
            if (!parse_number(word, vertex[axis]))
                lines_.damaged(fmt::format("{} is no coordinate", quoted(word)));
        }
        soup_.corners.push_back(welder_.vertex_of(vertex));
    }

    // The next word, left where it is; empty only at an end of the file that is allowed.
    std::string_view peek(std::string_view expected, bool may_end = false) {
        for (;;) {
            std::string_view words = line_;
            if (const std::string_view word = take_word(words); !word.empty())
                return word;
            if (!lines_.next(line_)) {
                line_ = {};
                if (may_end)
                    return {};
                lines_.damaged(fmt::format("the file breaks off before {}", expected));
            }
        }
    }

    bool next_word(std::string_view keyword, bool may_end = false) {
        const std::string_view word = peek(keyword, may_end);
        if (word.empty())
            return false;
        if (!is_keyword(word, keyword))
            lines_.damaged(fmt::format("expected {}, got {}", keyword, quoted(word)));
        take_word(line_);
        return true;
    }

    TextLines lines_;
    std::string_view line_;
    PolygonSoup soup_;
    Welder welder_;
};

} // namespace

bool is_binary_stl(std::string_view bytes) {
    return bytes.size() >= kHeader &&
           bytes.size() == kHeader + kTriangle * std::uint64_t{little_endian(bytes.data() + 80)};
}

PolygonSoup read_stl(const Source& source) {
    const std::size_t begin = source.bytes.find_first_not_of(" \t\r\n");
    const bool text = begin != std::string_view::npos && is_keyword(source.bytes.substr(begin, 5), "solid");
    return text && !is_binary_stl(source.bytes) ? StlTextReader(source).read() : read_binary(source);
}

} // namespace forceshade::mesh_file
