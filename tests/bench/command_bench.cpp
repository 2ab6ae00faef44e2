// Whole commands beside what bounds them, of one program or of two in turn:
//     command_bench PROGRAM [OLD] [--rounds N] [--only WORD] [-- FURTHER ARGUMENTS]
// Medians. The bound is the sum of what no implementation is spared of these stages: reading the bytes of the inputs
// and writing those of the outputs through to the disk, both measured here, and the plan, the kernels (with what goes
// to the device and back) and the encoding, as the program accounts for them (explore does not tell of encoding). And
// of meshes, how fast a field is beside one query of the tree a voxel.
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numeric>
#include <optional>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <glm/common.hpp>
#include <nlohmann/json.hpp>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "host/output/files.h"
#include "host/sweep/sweep.h"
#include "tests/bench/geodesic.h"
#include "tests/bench/tree_queries.h"
#include "tests/io/folder.h"
#include "tests/mesh/written_files.h"
#include "tests/places.h"

namespace forceshade::bench {
namespace {

using Json = nlohmann::json;

struct Row {
    std::string name;
    std::vector<std::string> arguments; /* of the program; --out is last */
    std::filesystem::path input;        /* that it reads; none: nothing worth counting */
    std::string mesh;                   /* its scene, if it has a mesh and a field */
};

struct Ran {
    double wall = 0, cpu = 0;                /* s */
    double plan = 0, kernel = 0, encode = 0; /* s, as told */
    double voxels = 0, bytes = 0;            /* of the grid; written */
    std::string engine;                      /* that computed */
};

double seconds_of(const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

// Runs the program in the current folder; what it prints goes to `out`. The time of the processor is that of the
// process.
Ran run(const std::string& program, std::vector<std::string> arguments, const std::filesystem::path& out) {
    arguments.insert(arguments.begin(), program);
    std::vector<char*> pointers;
    for (std::string& argument : arguments)
        pointers.push_back(argument.data());
    pointers.push_back(nullptr);
    for (const char* written : {"field.exr", "paths.exr", "paths.paths.csv"}) // else the program would refuse to
        std::filesystem::remove(written);
    Ran ran;
    int status = 0;
    rusage used{};
    ran.wall = seconds([&] {
        const pid_t child = ::fork();
        if (child == 0) {
            ::dup2(::open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666), STDOUT_FILENO);
            ::execv(program.c_str(), pointers.data());
            ::_exit(127);
        }
        ::wait4(child, &status, 0, &used);
    });
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
        fmt::print(stderr, "{} failed\n", fmt::join(arguments, " "));
        std::exit(1);
    }
    ran.cpu = seconds_of(used.ru_utime) + seconds_of(used.ru_stime);
    return ran;
}

void add_case(const Json& record, double encoders, Ran& ran) {
    const auto add = [&](const Json& times) {
        const auto of = [&](const char* stage) { return times.value(stage, 0.0); };
        ran.plan += of("plan");
        ran.kernel += of("upload") + of("kernel") + of("read_back");
        ran.encode += of("encode") / encoders;
    };
    add(record.at("seconds"));
    ran.voxels += record.value("voxels", 0.0);
    ran.engine = record.at("engine").at("kind");
    for (const Json& file : record.at("files"))
        ran.bytes += file.at("bytes").get<double>();
}

// What the command tells of its stages, on stdout or in a manifest.
void account(const Row& row, const std::filesystem::path& printed, Ran& ran) {
    if (row.arguments.front() == "sweep") { // volumes are encoded at the same time, one a thread
        std::ifstream file(std::filesystem::path(row.arguments.back()) / "manifest.json");
        const Json told = Json::parse(file);
        for (const Json& one : told.at("cases"))
            add_case(one, std::max(1u, std::thread::hardware_concurrency()), ran);
    } else if (row.arguments.front() == "field") {
        std::ifstream file(printed);
        add_case(Json::parse(file), 1, ran);
    } else if (row.arguments.front() == "explore") {
        std::ifstream file(printed);
        const Json told = Json::parse(file);
        ran.kernel =
            told.at("paths").get<double>() * told.at("steps").get<double>() / told.at("steps_per_second").get<double>();
        ran.engine = told.at("engine").at("kind");
        for (const Json& one : told.at("files"))
            ran.bytes += one.at("bytes").get<double>();
    }
}

double read_seconds(const std::filesystem::path& path) {
    if (path.empty())
        return 0;
    return seconds([&] {
        std::ifstream file(path, std::ios::binary);
        std::vector<char> bytes(std::size_t(1) << 20);
        while (file.read(bytes.data(), static_cast<std::streamsize>(bytes.size())))
            continue;
    });
}

// Through to the disk, as the program's files go.
double write_seconds(double bytes) {
    const std::vector<char> content(static_cast<std::size_t>(bytes), 'x');
    return seconds([&] {
        const int file = ::open("written", O_WRONLY | O_CREAT | O_TRUNC, 0666);
        if (::write(file, content.data(), content.size()) < 0 || ::fsync(file) != 0)
            std::exit(1);
        ::close(file);
    });
}

FieldTables<float> field_of(const std::string& scene) {
    const PreparedCase prepared = CasePreparation().prepare(read_scene(scene));
    return make_tables<float>(prepared.one.scene, prepared.images, Extent::what_varies);
}

void write_ball(unsigned frequency, const std::string& name) {
    PolygonSoup ball = geodesic(frequency);
    for (glm::dvec3& vertex : ball.vertices) // as many digits as programs write
        vertex = glm::round(1e9 * vertex) / 1e9;
    write_file_atomically(name, testing::as_obj(ball));
}

std::string write_scene(const std::string& name, const std::string& text) {
    write_file_atomically(name + ".toml", text);
    return name + ".toml";
}

std::vector<Row> rows() {
    const std::string bump = "[surface]\nkind = \"bump\"\nradius = \"600 mil\"\nfacets = 3\n[force]\nshading = "
                             "\"reference\"\n";
    const std::string dimple = "[surface]\nkind = \"height_map\"\nfunction = \"gaussian\"\nradius = \"5 mm\"\n[force]\n"
                               "shading = \"height_map\"\n";
    const std::string small = "[grid]\nsize = [64, 64, 64]\norigin = [\"-16 mm\", \"-16 mm\", \"-16 mm\"]\nspacing = "
                              "\"0.5 mm\"\n";
    const std::string large = "[grid]\nsize = [256, 256, 256]\norigin = [\"-25 mm\", \"-25 mm\", \"-50 mm\"]\n"
                              "spacing = \"0.2 mm\"\n";
    const std::string strokes = "[paths]\npress = \"1 N\"\n", circles = "[paths]\nkind = \"circle\"\n";
    std::vector<Row> all{{"--version", {"--version"}, "", ""}};
    const auto field = [&](const std::string& name, const std::string& scene) -> Row& {
        return all.emplace_back(
            Row{name, {"field", write_scene(name, scene), "--json", "--quiet", "--out", "field.exr"}, "", ""});
    };
    const auto explore = [&](const std::string& name, const std::string& scene) {
        all.push_back({name, {"explore", write_scene(name, scene), "--json", "--quiet", "--out", "paths.exr"}, "", ""});
    };
    field("field-64", bump + small);
    field("field-bump", bump);
    field("field-bump-256", bump + large);
    field("field-dimple-256", dimple + large);
    for (const auto& [name, frequency] : {std::pair{"5k", 16u}, {"100k", 71u}, {"1M", 224u}}) {
        const std::string file = fmt::format("ball-{}.obj", name);
        write_ball(frequency, file);
        Row& row = field(fmt::format("field-ball-{}", name),
                         fmt::format("[surface]\nkind = \"mesh\"\nfile = \"{}\"\ntransform = {{ scale = 0.025 }}\n"
                                     "[grid]\nsamples = 128\n",
                                     file));
        row.input = file;
        row.mesh = row.arguments[1];
    }
    explore("explore-bump", bump + strokes);
    const std::string spot = "[surface]\nkind = \"mesh\"\nfile = \"" + in_source("tests/data/spot.obj") +
                             "\"\ntransform = { scale = 0.05, rotate = [\"90 deg\", \"0 deg\", \"0 deg\"] }\n";
    explore("explore-spot-strokes", spot + strokes);
    explore("explore-spot-circles", spot + circles);
    all.push_back({"sweep", {"sweep", "--fresh", "--quiet", "--out", "sweep"}, "", ""});
    return all;
}

template <typename Value> double median_of(const std::vector<Ran>& runs, Value Ran::*value) {
    std::vector<double> values;
    for (const Ran& one : runs)
        values.push_back(one.*value);
    return median(values);
}

struct Options {
    std::vector<std::string> programs, further;
    int rounds = 5;
    std::string only;
};

void measure(const Row& row, const Options& options) {
    std::vector<std::vector<Ran>> runs(options.programs.size());
    std::vector<double> reads, writes, rates;
    std::optional<FieldTables<float>> field;
    if (!row.mesh.empty())
        field = field_of(row.mesh);
    for (int round = -1; round < options.rounds; ++round) // the first warms caches, of kernels too
        for (std::size_t i = 0; i < runs.size(); ++i) {
            const std::size_t which = round % 2 == 0 ? i : runs.size() - 1 - i;
            std::vector<std::string> arguments = row.arguments;
            if (row.name != "--version")
                arguments.insert(arguments.begin() + 1, options.further.begin(), options.further.end());
            Ran ran = run(options.programs[which], arguments, "printed");
            account(row, "printed", ran);
            if (round < 0)
                continue;
            if (which == 0) {
                reads.push_back(read_seconds(row.input));
                writes.push_back(ran.bytes > 0 ? write_seconds(ran.bytes) : 0);
                if (field)
                    rates.push_back(voxels_of(*field) / query_seconds(*field));
            }
            runs[which].push_back(std::move(ran));
        }
    const std::vector<Ran>& mine = runs.front();
    const double wall = median_of(mine, &Ran::wall), plan = median_of(mine, &Ran::plan),
                 kernel = median_of(mine, &Ran::kernel), encode = median_of(mine, &Ran::encode);
    const double bound = median(reads) + plan + kernel + encode + median(writes);
    std::string line =
        fmt::format("{:<22} {:<4} {:>8.1f} {:>8.1f} {:>7.1f} {:>7.1f} {:>7.1f} {:>7.1f} {:>7.1f} {:>8.1f}", row.name,
                    mine.front().engine, 1e3 * wall, 1e3 * median_of(mine, &Ran::cpu), 1e3 * median(reads), 1e3 * plan,
                    1e3 * kernel, 1e3 * encode, 1e3 * median(writes), 1e3 * bound);
    line += bound > 0 ? fmt::format(" {:>6.2f}", wall / bound) : fmt::format(" {:>6}", "");
    if (runs.size() > 1)
        line += fmt::format(" {:>9.1f} {:>9.1f} {:>6.2f}", 1e3 * median_of(runs[1], &Ran::wall),
                            1e3 * median_of(runs[1], &Ran::cpu), median_of(runs[1], &Ran::wall) / wall);
    fmt::print("{}\n", line);
    if (field) {
        const double rate = mine.front().voxels / (plan + kernel);
        fmt::print("    {:.2f} M voxels/s planned and computed, {:.2f} M voxels/s by queries of the tree: {:.2f}\n",
                   1e-6 * rate, 1e-6 * median(rates), rate / median(rates));
    }
    std::fflush(stdout);
}

std::optional<Options> read_options(int argc, char** argv) {
    Options options;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        if (word == "--") {
            options.further.assign(argv + i + 1, argv + argc);
            break;
        }
        if ((word == "--rounds" || word == "--only") && i + 1 < argc)
            word == "--rounds" ? void(options.rounds = std::max(1, std::atoi(argv[++i])))
                               : void(options.only = argv[++i]);
        else
            options.programs.push_back(std::filesystem::absolute(word));
    }
    if (options.programs.empty() || options.programs.size() > 2)
        return std::nullopt;
    return options;
}

int compare(const Options& options) {
    const testing::Folder folder;
    std::filesystem::current_path(folder.path());
    fmt::print("{}, {} threads; medians of {}, ms\n", cpu_name(), std::thread::hardware_concurrency(), options.rounds);
    fmt::print("{:<22} {:<4} {:>8} {:>8} {:>7} {:>7} {:>7} {:>7} {:>7} {:>8} {:>6}", "command", "on", "wall", "cpu",
               "read", "plan", "kernel", "encode", "write", "bound", "ratio");
    if (options.programs.size() > 1)
        fmt::print(" {:>9} {:>9} {:>6}", "old wall", "old cpu", "old/it");
    fmt::print("\n");
    for (const Row& row : rows())
        if (row.name.find(options.only) != std::string::npos)
            measure(row, options);
    std::filesystem::current_path("/");
    return 0;
}

} // namespace
} // namespace forceshade::bench

int main(int argc, char** argv) {
    if (const auto options = forceshade::bench::read_options(argc, argv))
        return forceshade::bench::compare(*options);
    fmt::print(stderr, "command_bench PROGRAM [OLD] [--rounds N] [--only WORD] [-- FURTHER ARGUMENTS]\n");
    return 2;
}
