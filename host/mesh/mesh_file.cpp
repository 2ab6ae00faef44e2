// Which format a file has, STL, which only its length tells from text, and what the readers share.
#include "host/mesh/mesh_file.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <charconv>
#include <cmath>
#include <future>

#include <locale.h>
#include <stdlib.h>

#include "host/long_run.h"
#include "host/mesh/formats.h"
#include "host/mesh/places.h"
#include "host/numbers.h"
#include "host/output/files.h"
#include "host/reference/chunks.h"

namespace forceshade::mesh_file {

// Lines, words and numbers, and the count of skipped elements.

namespace {

// Lines and words are short, and searching through them for one of several characters with string_view's functions
// takes several times as long.
bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

void skip_blanks(std::string_view& line) {
    line.remove_prefix(static_cast<std::size_t>(std::ranges::find_if_not(line, is_blank) - line.begin()));
}

// std::from_chars leaves the value alone where it is beyond the range of double, on either side.
double beyond_range(std::string_view word) {
    static const locale_t classic = ::newlocale(LC_ALL_MASK, "C", nullptr);
    return ::strtod_l(std::string(word).c_str(), nullptr, classic);
}

std::string_view without_plus(std::string_view word) {
    if (word.size() > 1 && word[0] == '+' && word[1] != '-')
        word.remove_prefix(1);
    return word;
}

} // namespace

TextLines::TextLines(std::string file, std::string_view text, std::size_t number)
    : file_(std::move(file)), text_(text), number_(number) {}

bool TextLines::next(std::string_view& line) {
    if (text_.empty())
        return false;
    ++number_;
    const auto end = static_cast<std::size_t>(
        std::ranges::find_if(text_, [](char c) { return c == '\n' || c == '\r'; }) - text_.begin());
    line = text_.substr(0, end);
    if (line.starts_with("\xEF\xBB\xBF")) // not only in the first: files are joined as they are
        line.remove_prefix(3);
    has_end_ = end < text_.size();
    if (!has_end_) {
        text_ = {};
        return true;
    }
    const bool two = text_[end] == '\r' && end + 1 < text_.size() && text_[end + 1] == '\n';
    text_.remove_prefix(end + (two ? 2 : 1));
    return true;
}

bool TextLines::next_words(std::string_view& line) {
    while (next(line)) {
        line = line.substr(0, line.find('#'));
        skip_blanks(line);
        if (!line.empty())
            return true;
    }
    return false;
}

std::string_view take_word(std::string_view& line) {
    skip_blanks(line);
    const auto end = static_cast<std::size_t>(std::ranges::find_if(line, is_blank) - line.begin());
    const std::string_view word = line.substr(0, end);
    line.remove_prefix(end);
    return word;
}

std::string in_quotes(std::string_view word) {
    constexpr std::size_t kMost = 24;
    std::string text = "\"";
    for (const char c : word.substr(0, kMost))
        text += c < ' ' || c == '\x7F' ? '?' : c; // bytes beyond ASCII are negative: shown as ? too
    return text + (word.size() > kMost ? "...\"" : "\"");
}

bool parse_number(std::string_view word, double& value) {
    word = without_plus(word);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (end != word.data() + word.size() || error == std::errc::invalid_argument)
        return false;
    if (error == std::errc::result_out_of_range)
        value = beyond_range(word);
    return true;
}

bool parse_integer(std::string_view word, std::int64_t& value) {
    word = without_plus(word);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    return error == std::errc() && end == word.data() + word.size();
}

bool has_only_numbers(std::string_view line) {
    std::string_view word = take_word(line);
    if (word.empty())
        return false;
    double value = 0;
    for (; !word.empty(); word = take_word(line))
        if (!parse_number(word, value) && word.find_first_not_of("/-0123456789") != std::string_view::npos)
            return false;
    return true;
}

bool looks_like_text(std::string_view bytes) {
    constexpr std::size_t kLooked = 1024;
    return bytes.substr(0, kLooked).find('\0') == std::string_view::npos;
}

bool is_keyword(std::string_view word, std::string_view keyword) {
    return std::ranges::equal(word, keyword,
                              [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b; });
}

void Skipped::add(const Kind& kind, std::size_t place) {
    const auto known = std::ranges::find(entries_, kind.one, [](const Entry& entry) { return entry.kind.one; });
    if (known == entries_.end())
        entries_.push_back({kind, 1, place});
    else
        ++known->count;
}

std::vector<std::string> Skipped::warnings() const {
    std::vector<std::string> warnings;
    for (const auto& [kind, count, first] : entries_)
        warnings.push_back(fmt::format("{}: skipped ({}{} {})", numbers::counted(count, kind.one, kind.several),
                                       count == 1 ? "" : "the first ", where_, first));
    return warnings;
}

namespace {

// Where the next block of a text begins: at or behind a place, and at a line of the keyword.
std::size_t next_block(std::string_view text, std::size_t from, std::string_view keyword) {
    while (from < text.size()) {
        const std::size_t end = text.find('\n', from);
        if (end == std::string_view::npos)
            break;
        from = end + 1;
        std::string_view line = text.substr(from, 256);
        if (keyword.empty() || is_keyword(take_word(line), keyword))
            return from;
    }
    return text.size();
}

std::size_t count_lines(std::string_view text) {
    TextLines lines("", text);
    std::size_t count = 0;
    for (std::string_view line; lines.next(line);)
        count += take_word(line).empty() ? 0 : 1;
    return count;
}

} // namespace

std::optional<PolygonSoup>
read_in_blocks(std::string_view text, std::string_view keyword, bool counts_lines,
               const std::function<std::optional<PolygonSoup>(const TextBlock& block)>& read) {
    constexpr std::size_t kBlock = std::size_t(1) << 20, kLeast = 4 * kBlock; // bytes
    if (text.size() < kLeast)
        return std::nullopt;
    std::vector<TextBlock> blocks;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = next_block(text, begin + kBlock, keyword);
        blocks.push_back({text.substr(begin, end - begin), begin == 0, end == text.size()});
        begin = end;
    }
    const unsigned threads = most_threads();
    if (counts_lines)
        reference::share_out(threads, blocks.size(),
                             [&](std::size_t, std::size_t i) { blocks[i].lines = count_lines(blocks[i].text); });
    for (std::size_t i = 1; i < blocks.size(); ++i)
        blocks[i].lines_before = blocks[i - 1].lines_before + blocks[i - 1].lines;
    std::vector<std::optional<PolygonSoup>> parts(blocks.size());
    std::atomic<bool> is_plain{true};
    reference::share_out(threads, blocks.size(), [&](std::size_t, std::size_t i) {
        try {
            if (is_plain)
                parts[i] = read(blocks[i]);
        } catch (const std::exception&) { // which who reads the whole will throw
            parts[i].reset();
        }
        if (!parts[i])
            is_plain = false;
    });
    if (!is_plain)
        return std::nullopt;
    PolygonSoup soup;
    for (std::optional<PolygonSoup>& part : parts) {
        const auto before = static_cast<std::uint32_t>(soup.corners.size());
        soup.vertices.insert(soup.vertices.end(), part->vertices.begin(), part->vertices.end());
        soup.corners.insert(soup.corners.end(), part->corners.begin(), part->corners.end());
        for (const std::uint32_t begin : std::span(part->begins).subspan(1))
            soup.begins.push_back(before + begin);
        part.reset();
    }
    const auto highest = std::ranges::max_element(soup.corners);
    if (soup.vertices.empty() || (highest != soup.corners.end() && *highest >= soup.vertices.size()))
        return std::nullopt;
    return soup;
}

// STL, text and binary: triangles without vertices of their own.

std::uint64_t read_bits(const char* bytes, std::size_t size, bool big_endian) {
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < size; ++i)
        bits |= std::uint64_t{static_cast<unsigned char>(bytes[i])} << 8 * (big_endian ? size - 1 - i : i);
    return bits;
}

namespace {

constexpr std::size_t kHeader = 84, kTriangle = 50; // bytes

float read_float(const char* bytes) {
    return std::bit_cast<float>(static_cast<std::uint32_t>(read_bits(bytes, 4)));
}

// Triangles whose vertices are their corners in order.
PolygonSoup triangles(std::vector<glm::dvec3> corners) {
    PolygonSoup soup;
    soup.vertices = std::move(corners);
    soup.corners.reserve(soup.vertices.size());
    soup.begins.reserve(soup.vertices.size() / 3 + 1);
    for (std::uint32_t corner = 0; corner < soup.vertices.size(); ++corner) {
        soup.vertices[corner] += 0.0; // -0 becomes 0
        soup.corners.push_back(corner);
        if (corner % 3 == 2)
            soup.end_facet();
    }
    return soup;
}

PolygonFile read_binary(const Source& source) {
    const std::optional<std::size_t> behind = bytes_behind_binary_stl(source.bytes);
    if (!behind) {
        const std::size_t size = source.bytes.size();
        if (size < kHeader)
            throw IoError("{}: {} bytes are too few for an STL file, and it is not text; it is damaged or truncated",
                          source.name, size);
        const std::uint64_t triangles = read_bits(source.bytes.data() + 80, 4);
        throw IoError("{}: a binary STL file that announces {} triangles has {} bytes, but this one has {}; it is "
                      "damaged or truncated",
                      source.name, triangles, kHeader + kTriangle * triangles, size);
    }
    std::vector<glm::dvec3> corners;
    const std::size_t end = source.bytes.size() - *behind;
    corners.reserve((end - kHeader) / kTriangle * 3);
    for (std::size_t begin = kHeader; begin < end; begin += kTriangle)
        for (int corner = 1; corner <= 3; ++corner) { // behind the normal
            const char* const at = source.bytes.data() + begin + 12 * corner;
            corners.emplace_back(read_float(at), read_float(at + 4), read_float(at + 8));
        }
    std::vector<std::string> warnings;
    if (*behind > 0)
        warnings.push_back(
            fmt::format("{} behind the last triangle (the file announces {}): skipped (at byte {}){}",
                        numbers::counted(*behind, "byte"), (end - kHeader) / kTriangle, end,
                        *behind % kTriangle == 0 ? fmt::format("; they may be {} more", *behind / kTriangle) : ""));
    return {triangles(std::move(corners)), "", "STL (binary)", std::move(warnings)};
}

constexpr std::array kStlKeywords = std::to_array<std::string_view>(
    {"solid", "facet", "normal", "outer", "loop", "vertex", "endloop", "endfacet", "endsolid"});

// Lines of text, such as comments and colours, are skipped wherever a keyword is expected. A keyword in the wrong place
// is an error: something is missing before it.
class StlTextReader {
public:
    explicit StlTextReader(const Source& source) : lines_(source.name, source.bytes) {}

    PolygonFile read() {
        if (read_parts(false, false) == 0)
            lines_.damaged("not an STL file: no line begins with solid or facet");
        return {triangles(std::move(corners_)), "", "STL (text)", skipped_.warnings()};
    }

    /// Of a part of a file that begins with a facet, unless it is the first; none where lines were skipped.
    std::optional<PolygonSoup> read_part(const TextBlock& block) {
        read_parts(!block.is_first, !block.is_last);
        if (!skipped_.empty())
            return std::nullopt;
        PolygonSoup soup;
        soup.vertices = std::move(corners_);
        return soup;
    }

private:
    /// Solids, their ends and facets; returns their number.
    /// \param open a solid is to end
    /// \param goes_on more follows behind the text
    std::size_t read_parts(bool open, bool goes_on) {
        std::size_t parts = 0, begin = 0; // the first corner of the solid
        for (;; ++parts) {
            const std::string_view word = next_part(!open || goes_on);
            if (word.empty())
                break;
            if (is_keyword(word, "facet")) {
                read_facet();
                open = true;
                continue;
            }
            const bool ends = is_keyword(word, "endsolid");
            if (!ends && open && corners_.size() > begin)
                lines_.damaged("expected facet or endsolid, got {}", in_quotes(word));
            open = !ends;
            begin = corners_.size();
            line_ = {}; // the name
        }
        return parts;
    }

    // Solid, endsolid or facet, left where it is; empty at the end of the file.
    std::string_view next_part(bool may_end) {
        for (;;) {
            const std::string_view word = peek("facet or endsolid", may_end);
            if (word.empty() || is_keyword(word, "facet") || is_keyword(word, "solid") || is_keyword(word, "endsolid"))
                return word;
            skip_text("facet or endsolid", word);
        }
    }

    void skip_text(std::string_view expected, std::string_view word) {
        if (std::ranges::any_of(kStlKeywords, [&](std::string_view keyword) { return is_keyword(word, keyword); }))
            lines_.damaged("expected {}, got {}", expected, in_quotes(word));
        skipped_.add(kTextLine, lines_.line_number());
        line_ = {};
    }

    void read_facet() {
        next_word("facet");
        next_word("normal");
        for (int axis = 0; axis < 3; ++axis) // ignored, often nan
            if (peek("a normal").empty() || take_word(line_).empty())
                lines_.damaged("a normal has three coordinates");
        next_word("outer");
        next_word("loop");
        for (int corner = 0; corner < 3; ++corner)
            read_vertex();
        next_word("endloop");
        next_word("endfacet");
    }

    void read_vertex() {
        next_word("vertex");
        corners_.push_back(read_coordinates(
            lines_, [] { return ""; },
            [&] {
                peek("a coordinate");
                return take_word(line_);
            }));
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
                lines_.damaged("the file breaks off before {}", expected);
            }
        }
    }

    // Of a facet. A number there may be a coordinate, and is not text.
    void next_word(std::string_view keyword) {
        for (;;) {
            const std::string_view word = peek(keyword);
            double value = 0;
            if (is_keyword(word, keyword))
                break;
            if (parse_number(word, value))
                lines_.damaged("expected {}, got {}", keyword, in_quotes(word));
            skip_text(keyword, word);
        }
        take_word(line_);
    }

    TextLines lines_;
    std::string_view line_;
    std::vector<glm::dvec3> corners_;
    Skipped skipped_{"in line"};
};

} // namespace

std::optional<std::size_t> bytes_behind_binary_stl(std::string_view bytes) {
    if (bytes.size() < kHeader)
        return {};
    const std::size_t triangles = read_bits(bytes.data() + 80, 4), needed = kHeader + kTriangle * triangles;
    if (bytes.size() < needed || (triangles == 0 && bytes.size() > needed))
        return {};
    return bytes.size() - needed;
}

PolygonFile read_stl(const Source& source) {
    if (!looks_like_text(source.bytes) || bytes_behind_binary_stl(source.bytes))
        return read_binary(source);
    if (auto soup = read_in_blocks(source.bytes, "facet", false, [&](const TextBlock& block) {
            return StlTextReader({source.name, block.text}).read_part(block);
        }))
        return {triangles(std::move(soup->vertices)), "", "STL (text)"};
    return StlTextReader(source).read();
}

} // namespace forceshade::mesh_file

namespace forceshade {

namespace {

using mesh_file::Source;

struct Format {
    std::string_view name, extension;
    PolygonFile (*read)(const Source&);
};

constexpr std::array<Format, 4> kFormats{{{"OBJ", ".obj", mesh_file::read_obj},
                                          {"OFF", ".off", mesh_file::read_off},
                                          {"PLY", ".ply", mesh_file::read_ply},
                                          {"STL", ".stl", mesh_file::read_stl}}};

// The format that the first bytes suggest; null if none.
const Format* format_of_contents(std::string_view bytes) {
    const auto& [obj, off, ply, stl] = kFormats;
    const std::optional<std::size_t> behind = mesh_file::bytes_behind_binary_stl(bytes);
    mesh_file::TextLines lines("", bytes.substr(0, 65536));
    std::string_view line;
    const std::string_view word = lines.next_words(line) ? mesh_file::take_word(line) : std::string_view();
    if (word == "ply" && behind != 0) // a binary PLY file may by chance have a small number where STL has its count
        return &ply;
    if (behind)
        return &stl;
    if (!mesh_file::looks_like_text(bytes))
        return nullptr;
    if (mesh_file::parse_off_keyword(word))
        return &off;
    if (mesh_file::is_keyword(word.substr(0, 5), "solid"))
        return &stl;
    for (const std::string_view keyword : {"v", "vt", "vn", "f", "o", "g", "mtllib", "usemtl", "s"})
        if (word == keyword)
            return &obj;
    return nullptr;
}

const Format& format_of(const std::string& name, const std::filesystem::path& path, std::string_view bytes) {
    const std::string extension = path.extension().string();
    const auto named = std::ranges::find_if(
        kFormats, [&](const Format& format) { return mesh_file::is_keyword(extension, format.extension); });
    const Format* contents = format_of_contents(bytes);
    const std::string looks =
        contents ? fmt::format("its contents look like {}", contents->name) : "its contents look like none of them";
    if (named == kFormats.end())
        throw UsageError("{}: a mesh is read from a file with the extension .obj, .off, .ply, .stl; {}", name, looks);
    if (contents && contents != named)
        throw UsageError("{}: the extension says {}, but {}; rename it to {}", name, named->name, looks,
                         contents->extension);
    return *named;
}

void refuse_what_is_not_finite(const std::string& name, const PolygonSoup& polygons) {
    for (std::size_t i = 0; i < polygons.vertices.size(); ++i) {
        const glm::dvec3& vertex = polygons.vertices[i];
        if (!std::isfinite(vertex.x) || !std::isfinite(vertex.y) || !std::isfinite(vertex.z))
            throw UsageError(
                "{}: vertex {} of {} (counted from 1) is ({}, {}, {}); every coordinate must be a finite number", name,
                i + 1, polygons.vertices.size(), vertex.x, vertex.y, vertex.z);
    }
}

void require_normals(const std::string& name, const PolygonSoup& polygons) {
    if (polygons.normals.empty())
        throw UsageError(
            "{}: has no vertex normals; normals = \"file\" is for an OBJ file with vn and corners such as 7//3, or a "
            "PLY file with nx, ny and nz: take \"plain\" or \"angle\", which follow from the facets",
            name);
    for (std::size_t i = 0; i < polygons.corners.size(); ++i) {
        const glm::dvec3 &normal = polygons.normals[i], &place = polygons.vertices[polygons.corners[i]];
        if (normal == glm::dvec3(0) || !std::isfinite(normal.x + normal.y + normal.z))
            throw UsageError("{}: the vertex at ({}, {}, {}) has the normal ({}, {}, {}), which is not a direction",
                             name, place.x, place.y, place.z, normal.x, normal.y, normal.z);
    }
}

} // namespace

PolygonFile read_polygons(const std::filesystem::path& path, bool normals) {
    const Stage stage("reading " + path.filename().string());
    constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 32;
    if (const std::uint64_t size = ReadableFile(path).size(); size > kMostBytes)
        throw IoError("{}: {} bytes; a mesh is read from a file of up to 4 GiB", path.string(), size);
    return parse_polygons(path, read_file(path), normals);
}

namespace {

/// Steps after reading, for every format.
void finish(const std::string& name, bool normals, PolygonFile& file) {
    refuse_what_is_not_finite(name, file.polygons);
    if (normals)
        require_normals(name, file.polygons);
    file.joined_vertices = join_vertices(file.polygons).vertices;
}

} // namespace

PolygonFile parse_polygons(const std::filesystem::path& path, std::string_view bytes, bool normals) {
    const std::string name = path.string();
    if (bytes.empty())
        throw IoError("{}: the file is empty", name);
    std::future<std::string> sha256 = std::async(std::launch::async, [bytes] { return sha256_of(bytes); });
    PolygonFile file = format_of(name, path, bytes).read({name, bytes, normals});
    finish(name, normals, file);
    if (file.format.starts_with("STL"))
        file.joined_vertices = 0; // it has no vertices of its own
    file.sha256 = sha256.get();
    return file;
}

PolygonFile polygons_of(const std::string& name, std::vector<glm::dvec3> vertices,
                        std::span<const std::int64_t> corners, std::span<const std::size_t> counts, bool normals) {
    PolygonFile file;
    file.format = "arrays";
    std::string bytes;
    const auto add = [&](const void* data, std::size_t size) { bytes.append(static_cast<const char*>(data), size); };
    add(vertices.data(), vertices.size() * sizeof(glm::dvec3));
    add(corners.data(), corners.size_bytes());
    add(counts.data(), counts.size_bytes());
    file.sha256 = sha256_of(bytes);
    file.polygons.vertices = std::move(vertices);
    mesh_file::Skipped skipped("at facet");
    for (std::size_t facet = 0, first = 0; facet < counts.size(); first += counts[facet++]) {
        const std::span<const std::int64_t> outline = corners.subspan(first, counts[facet]);
        for (const std::int64_t corner : outline) {
            if (corner < 0 || static_cast<std::size_t>(corner) >= file.polygons.vertices.size())
                throw UsageError("{}: facet {} has the vertex {}; vertices are counted from 0, and there are {}", name,
                                 facet, corner, file.polygons.vertices.size());
            if (outline.size() >= 3)
                file.polygons.corners.push_back(static_cast<std::uint32_t>(corner));
        }
        if (outline.size() >= 3)
            file.polygons.end_facet();
        else
            skipped.add(mesh_file::kShortFaces[outline.size()], facet);
    }
    file.warnings = skipped.warnings();
    finish(name, normals, file);
    return file;
}

} // namespace forceshade
