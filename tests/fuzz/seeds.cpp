// fuzz_seeds FOLDER: writes FOLDER/TARGET/..., small inputs that the program itself makes or that are in tests/data,
// and FOLDER/TARGET.dict, the words of the target's language.
#include <cstring>
#include <fstream>
#include <random>
#include <set>

#include <nlohmann/json.hpp>

#include "host/error.h"
#include "host/output/exr_volume.h"
#include "host/output/files.h"
#include "host/output/json.h"
#include "host/scene/schema.h"
#include "host/scene/study.h"
#include "host/study/study_data.h"
#include "tests/fuzz/fuzz.h"
#include "tests/io/picture.h"
#include "tests/mesh/shapes.h"
#include "tests/mesh/written_files.h"
#include "tests/places.h"
#include "tests/report/sample_folder.h"
#include "tests/report/samples.h"

namespace forceshade {
namespace {

class Seeds {
public:
    explicit Seeds(std::filesystem::path folder) : folder_(std::move(folder)) {}

    void add(const std::string& target, std::string_view bytes) {
        std::filesystem::create_directories(folder_ / target);
        std::ofstream(folder_ / target / fmt::format("seed-{}", ++count_), std::ios::binary) << bytes;
    }
    void add_words(const std::string& target, const std::set<std::string>& words) {
        std::ofstream file(folder_ / (target + ".dict"));
        for (const std::string& word : words) {
            file << '"';
            for (const char c : word)
                file << (c == '"' || c == '\\' || c < ' ' || c > '~'
                             ? fmt::format("\\x{:02x}", static_cast<unsigned char>(c))
                             : std::string(1, c));
            file << "\"\n";
        }
    }
    /// A folder for files that become seeds.
    std::filesystem::path scratch() const {
        std::filesystem::create_directories(folder_ / "scratch");
        return folder_ / "scratch";
    }

private:
    std::filesystem::path folder_;
    int count_ = 0;
};

/// For targets that make something out of any bytes. The first byte, below `kinds`, chooses what.
void add_random(Seeds& seeds, const std::string& target, std::mt19937& random, int kinds) {
    for (int i = 0; i < 40; ++i) {
        std::string bytes(static_cast<std::size_t>(60 + random() % 400), '\0');
        for (char& byte : bytes)
            byte = static_cast<char>(random() % (i % 2 ? 256 : 100));
        bytes[0] = static_cast<char>(i % kinds);
        seeds.add(target, bytes);
    }
}

void add_scenes(Seeds& seeds) {
    seeds.add("toml", schema_text());
    seeds.add("toml", default_study_toml());
    for (const std::string_view what : kStarters)
        seeds.add("toml", starter_scene(what, "mesh.obj", "mm", "scene.toml"));
    seeds.add("toml", "[surface]\nkind = [\"bump\", \"mesh\"]\nfile = \"a.obj\"\n[[variant]]\n[texture]\nfunction = "
                      "\"sine\"\n[[variant]]\ngrid = { spacing = [\"1 mm\", \"2 mm\", \"3 mm\"] }\n");
    for (const char* text : {"quantity 1e-3 kg m^2/s^2", "quantity 600 mil", "quantity 5 N s/m", "quantity 90 deg",
                             "override surface.radius=[\"600 mil\", \"1 in\"]", "override paths.kind=taps",
                             "quantity 1234567.891 mil", "quantity 0.3 in",
                             "override surface.radius=5 in\n[[variant]]\nsurface.radius = \"1 in\"\n[[variant]]\n"
                             "surface.width = \"2 in\"\nsurface.radius = [\"3 in\", \"4 in\"]\n",
                             "[paths]\nloop = \"closed\"\n[hand]\nmass = \"0.2 kg\"\ndamping = \"3 N s/m\"\n",
                             "[[variant]]\ntexture = {}\n[[variant]]\nsurface.facets = 3\n",
                             "[grid]\nspacing = [[\"1 mm\"], [\"2 mm\"]]\n",
                             "[surface]\nkind = \"mesh\"\nfile = \"a\\u0001b\\\\c.obj\"\n"})
        seeds.add("toml", text);
    for (const char* text :
         {"[[variant]]\nsurface.kind = \"mesh\"\nsurface.file = \"a.obj\"\nsurface.sha256 = \"{0}\"\n[[variant]]\n"
          "surface.kind = \"height_map\"\nsurface.file = \"u.exr\"\nsurface.sha256 = \"{0}\"\n",
          "[texture]\nfile = \"u.exr\"\nsha256 = \"{0}\"\n",
          "[surface]\nkind = \"mesh\"\nfile = [\"a.obj\", \"b.obj\"]\nsha256 = [\"{0}\"]\n",
          "[surface]\nkind = \"mesh\"\nfile = [\"a.obj\", \"b.obj\"]\nsha256 = [\"{0}\", \"{1}\"]\n"})
        seeds.add("toml", fmt::format(fmt::runtime(text), std::string(64, 'a'), std::string(64, 'b')));
    for (const char* text : {"quantity 7 mm", "quantity 7 N/mm", "quantity 3 cm", "quantity -0 m", "quantity 2 mm^2/m",
                             "quantity 3 rad^2/deg"})
        seeds.add("toml", text);
    std::set<std::string> words{"[[variant]]", "= [\"",   "\"]",   " = {", "deg",       "mil",
                                "kg",          "N/mm",    "e-300", "µm",   "quantity ", "override ",
                                "\"\"\"",      "\\u00e9", "nan",   "inf",  "0x1",       "1979-05-27"};
    for (const Key& key : schema_keys()) {
        if (key.kind == ValueKind::quantity && key.sign != Sign::any) // refused
            seeds.add("toml", fmt::format("override {}={} {}", key.path(), key.sign == Sign::positive ? 0 : -1,
                                          dimension_info(key.dimension).unit));
        if (key.kind == ValueKind::quantity && key.sign == Sign::not_negative)
            seeds.add("toml", fmt::format("override {}=0 {}", key.path(), dimension_info(key.dimension).unit));
        words.emplace(key.table);
        words.emplace(key.name);
        words.insert(key.path());
        words.insert(key.choices.begin(), key.choices.end());
    }
    words.erase("");
    seeds.add_words("toml", words);
}

void add_meshes(Seeds& seeds) {
    constexpr std::string_view kExtensions[] = {".obj", ".off", ".ply", ".stl"};
    for (const PolygonSoup& soup : {testing::fine_tetrahedron(), shapes::cube(true)})
        for (const auto& [extension, bytes] : testing::all_formats(soup)) {
            const auto format = std::ranges::find(kExtensions, extension) - std::begin(kExtensions);
            seeds.add("mesh_file", static_cast<char>(format) + bytes);
        }
    seeds.add("mesh_file", '\0' + read_file(in_source("tests/data/bump.obj")));
    seeds.add(
        "mesh_file",
        std::string("\4v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvt 0 0\nf 1/1/1 2//1 -1/-1/-1\nf 1//1 \\\n2//1 3//1\n"));
    seeds.add("mesh_file",
              std::string("\6ply\r\nformat ascii 1.0\r\nelement vertex 3\r\nproperty float x\r\nproperty float "
                          "y\r\nproperty float z\r\nproperty float nx\r\nproperty float ny\r\nproperty float nz\r\n"
                          "element face 1\r\nproperty list uchar int vertex_index\r\nend_header\r\n0 0 0 0 0 1\r\n"
                          "1 0 0 0 0 1\r\n0 1 0 0 0 1\r\n3 0 1 2\r\n"));
    seeds.add("mesh_file", std::string("\1OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n")); // refused, only just
    seeds.add("mesh_file", std::string("\1OFF\n3 1 0\n0 0 1e400\n1 0 0\n0 1 0\n3 0 1 2\n"));
    seeds.add("mesh_file",
              std::string(
                  "\6ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
                  "property float nx\nproperty float ny\nproperty float nz\nelement face 2\nproperty list uchar int "
                  "vertex_index\nend_header\n0 0 0 0 0 1\n1 0 0 0 1 0\n0 1 0 1 0 0\n1 1 0 0 0 -1\n3 0 1 2\n3 2 1 3\n"));
    const std::string strips = "element vertex 4\nproperty char x\nproperty char y\nproperty char z\nelement tristrips "
                               "1\nproperty list uchar char vertex_indices\nend_header\n";
    seeds.add("mesh_file", "\2ply\nformat ascii 1.0\n" + strips + "0 0 0\n1 0 0\n0 1 0\n0 0 1\n9 0 1 2 3 -1 3 2 2 0\n");
    seeds.add("mesh_file", "\2ply\nformat binary_big_endian 1.0\n" + strips +
                               std::string("\0\0\0\1\0\0\0\1\0\0\0\1\6\0\1\2\3\xFF\0", 19));
    seeds.add("mesh_file", std::string("\1COFF3 3 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1\n3 0 1 2\n0\nthe end\n"));
    seeds.add("mesh_file", std::string("\3\xEF\xBB\xBF; made by\nsolid a\\\ncolor 1 0 0\nfacet normal 0 0 1\nouter "
                                       "loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
                                       "endsolid\n"));
    seeds.add("mesh_file", '\3' + testing::as_stl_binary(shapes::cube(true)) + "behind");
    std::string obj = "made by\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\\\nl 1 2\np 1\nf 1 2\nf 1 2 \\ \n 3\n";
    obj.insert(obj.begin(), '\0');
    seeds.add("mesh_file", obj);
    std::set<std::string> words;
    for (const char* line :
         {"v |vn |vt |f |\n|\r\n|# |//|\\\n|OFF\n|COFF|NOFF|",
          "4OFF|BINARY|ply\n|format |ascii 1.0|binary_little_endian|binary_big_endian|element vertex |element face "
          "|property list |property |uchar|",
          "int |float |double |short |vertex_indices|end_header\n|comment |obj_info |tristrips | -1 |element edge |l 1 "
          "2\n|",
          "usemtl a\\\n|solid |facet normal |outer loop\n|vertex |endloop\n|endfacet\n|endsolid|nan|inf|1e308|-0|",
          " x\n| y\n| z\n| nx\n|"})
        for (const char* word = line; *word;) {
            const char* const end = std::strchr(word, '|');
            words.emplace(word, end);
            word = end + 1;
        }
    seeds.add_words("mesh_file", words);
    // Of soups and god-objects any bytes are one.
    std::mt19937 random(1);
    add_random(seeds, "prepare", random, 256);
    add_random(seeds, "god_object", random, 256);
}

/// The names of an object's members, and words that stand in it.
void collect_words(const Json& json, std::set<std::string>& words) {
    if (json.is_string() && json.get_ref<const std::string&>().size() < 20)
        words.insert(json.get<std::string>());
    for (const auto& [key, value] : json.items()) {
        if (json.is_object())
            words.insert('"' + key + "\":");
        if (json.is_structured())
            collect_words(value, words);
    }
}

void add_records(Seeds& seeds) {
    const std::filesystem::path folder = seeds.scratch();
    CaseRecord record = testing::write_sample_case(folder, {.size = {5, 3, 2}, .paths = true});
    record.deviation.emplace();
    record.files.push_back({"large.exr", "", (std::uint64_t{1} << 33) + 5});
    record.paths.emplace().deviation.emplace();
    record.paths->unfinished = 1;
    record.evaluated = record.voxels / 3;
    record.paths->deviation->angles = 3;
    record.paths->mean_depth = 0.0015;
    record.paths->work = 0.25;
    record.paths->engine_times.kernel = 0.5;
    record.paths->volume_times.read_back = 0.125;
    record.volume_times.read_back = 0.0625;
    CaseRecord all = record; // nothing left out
    all.name = "all";
    all.evaluated = all.voxels;
    testing::write_sample_manifest(folder, {record});
    const std::string one = Json::parse(record_json(record)).dump(),
                      manifest = Json::parse(read_file(folder / "manifest.json")).dump();
    study::StudyData data = testing::sample_study();
    for (study::Table& table : data.tables)
        table.rows.resize(std::min<std::size_t>(table.rows.size(), 9));
    data.tables.front().rows[1][1] = std::string("say \"b\"");
    study::Table& few = data.tables.emplace_back(data.tables.front()); // its column is written as its different cells
    few.name = "few";
    few.columns.resize(1);
    few.rows.clear();
    for (const char* word : {"a", "b", "a", "a", "b", "a", "a", "a", "b", "a"})
        few.rows.push_back({std::string(word)});
    data.findings = {{"sample", "A finding.", "", "here", "now", "for sure"}};
    const std::string study = study::data_json(data);
    Json too_many = Json::parse(study);
    too_many["run"]["cores"] = (std::uint64_t{1} << 32) + 1;
    Json one_less = Json::parse(study);
    one_less["tables"][0]["cells"].erase(0);
    data.figures.resize(1);
    data.tables.resize(1);
    const std::string short_study = study::data_json(data);
    std::set<std::string> words{"<script>",       "</script>", "<!--", "\\u003c", "&lt;",
                                "\\ud83d\\ude00", "null",      "true", "1e308",   "-1"};
    CaseRecord empty = record;
    empty.files.clear();
    Json negative = Json::parse(one);
    negative["voxels"] = -1;
    for (const std::string& text :
         {record_json(empty), negative.dump(), too_many.dump(), one_less.dump()}) // none is understood
        seeds.add("record", text);
    for (const std::string& text : {one, manifest, study, short_study}) {
        collect_words(Json::parse(text), words);
        seeds.add("report", text);
        seeds.add("record", text);
    }
    testing::write_sample_manifest(folder, {all});
    seeds.add("report", Json::parse(read_file(folder / "manifest.json")).dump());
    seeds.add("report", Json{{"cases", Json::array()}, {"program", "\"" + std::string(40, '[')}}.dump());
    words.erase("");
    seeds.add_words("record", words);
    seeds.add_words("report", words);
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (entry.path().extension() == ".exr")
            seeds.add("volume", read_file(entry.path()));
}

void add_volumes(Seeds& seeds) {
    int name = 0;
    for (const Compression compression : {Compression::none, Compression::zip1, Compression::zip, Compression::pxr24})
        for (const PixelType pixel : {PixelType::float32, PixelType::half}) {
            const std::filesystem::path path = seeds.scratch() / fmt::format("{}.exr", ++name);
            VolumeHeader header;
            header.size = {3, 2, 9};
            header.spacing = {1, 1, 1};
            header.compression = compression;
            header.pixel = pixel;
            VolumeWriter writer(path, header);
            std::vector<float> force(3 * 54);
            for (std::size_t i = 0; i < force.size(); ++i)
                force[i] = static_cast<float>(i % 7);
            writer.write(layout::FieldChunk<float>{3, 3, 0, 2, 0, 9, force, {}, {}, {}, {}}, 1);
            writer.finish();
            seeds.add("volume", read_file(path));
        }
}

void add_paths_volume(Seeds& seeds) {
    const std::filesystem::path path = seeds.scratch() / "paths.exr";
    const std::vector<layout::uint> steps(9, 11);
    PathVolumeHeader header;
    header.steps = 11;
    header.paths = 9;
    header.channels = layout::kChannelForce | layout::kChannelPosition;
    const std::vector<float> values(3 * 99, 1);
    PathVolumeWriter writer(path, header);
    PathRows<float> rows;
    rows.path_count = 9;
    rows.pitch = 11;
    rows.steps = steps;
    rows.position = values;
    rows.force = values;
    writer.write(rows);
    writer.finish();
    seeds.add("volume", read_file(path));
    std::mt19937 random(1);
    add_random(seeds, "volume", random, 2);
}

void add_pictures(Seeds& seeds) {
    const std::filesystem::path path = seeds.scratch() / "u";
    const std::vector<std::vector<png_byte>> rows(5, std::vector<png_byte>{0, 255, 7, 9, 100, 3, 3, 3});
    for (const int depth : {1, 8, 16})
        for (const bool interlaced : {false, true}) {
            testing::write_png(path, depth == 16 ? 4 : 8, rows, {depth, PNG_COLOR_TYPE_GRAY, interlaced});
            seeds.add("height_map", read_file(path));
        }
    const auto value = [](int x, int y) { return std::sin(x + 10.0 * y); };
    for (const double bad : {double(NAN), double(INFINITY)}) { // refused
        testing::write_exr(path, {{"Y", {Imf::FLOAT, [bad](int x, int y) { return x + y == 3 ? bad : 1; }}}});
        seeds.add("height_map", read_file(path));
    }
    std::mt19937 random(1);
    add_random(seeds, "height_map", random, 2);
    for (const Imf::Compression compression : {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIP_COMPRESSION,
                                               Imf::PIZ_COMPRESSION, Imf::PXR24_COMPRESSION})
        for (const bool tiled : {false, true}) {
            testing::write_exr(path, {{"Y", {tiled ? Imf::HALF : Imf::FLOAT, value}}},
                               {{{0, 0}, {4, 3}}, {{1, 0}, {4, 4}}, compression, tiled});
            seeds.add("height_map", read_file(path));
        }
}

void add_tables(Seeds& seeds) {
    seeds.add("csv", "path,t,x,y,z\n0,0,0.1,0,-1e-3\n0,0.001,0.2,0,-1e-3\n1,0,+1,2,3\n0,0.002,0,0,0\n");
    seeds.add("csv", "path,t,x,y,z\n0,0,-2e15,0,0\n"); // each of these is refused
    seeds.add("csv", "path,t,x,y,z\n0.5,0,0,0,0\n");
    seeds.add("csv", "path,t,x,y,z\n1e17,0,0,0,0\n");
    seeds.add("csv", "path,t,x,y,z\n0,1,0,0,0\n0,1,0,0,0\n");
    seeds.add("csv", "path,t,x,y,z\n0,0,0,0,0\n0,2,0,0,0\n0,1,0,0,0\n");
    seeds.add("csv", "path,t,x,y,z,x\n0,0,0,0,0,1\n");
    seeds.add("csv", "path,t,x,y,z\r\n\r\n7.0 \t,0  , 1,2,3\r\n");
    seeds.add("csv", "\xEF\xBB\xBFt , x,y,\"z\",path,force\r\n0,0,0,0,1e0,\"a,\"\"b\"\r\n\r\n1,1,1,1,1.0,\r\n");
    seeds.add("csv", "na\u00efve,path,t,x,y,z\n\u00e9\u00e9,0,0,none,0,0\n");
    seeds.add("csv", std::string("\0\1\5a,b \x0d\"x\n\0\x3f\xf0\0\0\0\0\0\1", 20));
    seeds.add("csv", std::string("\0\0\x9"
                                 "a \x5"
                                 "b",
                                 7));
    seeds.add_words("csv", {"path,t,x,y,z\n", "\"\"", "\r\n", ",", "nan", "1e308", "4.9e-324", "9007199254740993",
                            "18446744073709551615", "\xEF\xBB\xBF", "\xFF\xFE"});
}

void add_messages(Seeds& seeds) {
    std::set<std::string> words{"ws://", "[::1]:", "?device=", "dialect=values", "&", "1e999", "true", "null"};
    for (
        const char* message :
        {R"({"session_id":7,"inverse3":[{"device_id":"04BA","config":{"type":"inverse3","basis":{"permutation":"XZY"}},"status":{"calibrated":true,"ready":false}}],"verse_grip":[{"device_id":"61548"}]})",
         R"({"inverse3":[{"device_id":"A","state":{"cursor_position":{"x":0.5,"y":-1.25e-1,"z":0}},"status":{"power_supply":true,"started":true}}],"wireless_verse_grip":[{"state":{"buttons":{"a":true,"b":false,"c":true}}}]})",
         R"({"inverse3":[{"device_id":"04BAX","state":{"cursor_position":{"x":-11,"y":1,"z":0}}}]})",
         R"({"inverse3":[{"device_id":"A","state":{"cursor_position":{"x":-11,"y":1,"z":0}}}]})",
         R"({"inverse3":[{"device_id":"AB","state":{"cursor_position":{"x":1,"y":1,"z":0}}}]})",
         R"({"inverse3":[{"device_id":"04BA","status":{"calibrated":true,"ready":"yes","power_supply":1}}]})",
         R"({"inverse3":[{"device_id":"A","state":{"cursor_position":{"x":0,"y":0,"z":0}}}],"verse_grip":[{"state":{"buttons":{"a":true}}},{"state":{"buttons":{"b":true}}}]})",
         R"({"verse_grip":[]})", R"({"ok":true,"data":{"git_tag":"v3.6.1","project_version":"3.1.1.0"}})",
         R"({"ok":false,"error":"no"})"}) {
        collect_words(Json::parse(message), words);
        seeds.add("haply", message);
    }
    for (const char* text :
         {"X-YZ", "Y-ZX", "3.5.0-2-gce34c39e", "ws://[::1]:8500/x?device=04BA&dialect=values", "ws://a:65536"})
        seeds.add("haply", text);
    words.erase("");
    seeds.add_words("haply", words);
}

} // namespace
} // namespace forceshade

int main(int count, char** arguments) {
    if (count != 2)
        return 2;
    forceshade::Seeds seeds(arguments[1]);
    forceshade::add_scenes(seeds);
    forceshade::add_meshes(seeds);
    forceshade::add_records(seeds);
    forceshade::add_volumes(seeds);
    forceshade::add_pictures(seeds);
    forceshade::add_paths_volume(seeds);
    forceshade::add_tables(seeds);
    forceshade::add_messages(seeds);
    std::filesystem::remove_all(std::filesystem::path(arguments[1]) / "scratch");
}
