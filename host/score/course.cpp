// The files of the standard course: scenes, strokes, forces, what to do with them, and their SHA-256.
#include "host/score/course.h"

#include <algorithm>

#include <fmt/format.h>

#include "host/field/prepared_case.h"
#include "host/long_run.h"
#include "host/output/files.h"
#include "host/program.h"
#include "host/scene/study.h"
#include "host/score/measures.h"
#include "host/score/score.h"
#include "host/score/strokes.h"

namespace forceshade::score {
namespace {

constexpr const char* kReadme = R"(# Standard course for haptic renderers, version {version}

{scenes} scenes, {strokes} strokes on each, and the oracle's forces along them in double precision: on meshes those of a god-object with the
scene's shading, on the bump, which is no mesh, those of its force law. A renderer gets the same positions, whatever its forces, and its forces
are held against the oracle's.

    forceshade score DIR --renderer ./libmine.so --out scores

scores your renderer on all scenes; DIR is this folder. This scores the forces of another program along the strokes of one scene:

    forceshade score DIR/plane.toml --paths DIR/strokes/plane.csv --forces mine.csv --out scores

## Scenes

| scene | what it is |
|---|---|
{table}
Every stiffness is 1 N/mm. Meshes are closed, their triangles counterclockwise seen from outside. All of them are made by formulas, the scan
too: it is what a scanner would leave, not the scan of an object. A renderer without shading has an error on shaded scenes, which the score's
row "oracle without shading" shows; one without textures has one on the textured plane.

## Files

| file | what it holds |
|---|---|
| `NAME.toml` | the scene |
| `NAME.obj` | its mesh, in mm; the bump has none: its triangles follow from its numbers |
| `strokes/NAME.csv` | positions of the probe: `path`, `t` in s, `x`, `y` and `z` in m |
| `oracle/NAME.csv` | the same with the oracle's forces on the probe: `fx`, `fy` and `fz` in N |
| `SHA256SUMS` | SHA-256 of all these files, for `sha256sum -c SHA256SUMS` |

## Strokes

Each lasts 1 s at 1 kHz. They are the same on every scene, laid on its nominal surface, and begin and end about 1 mm above it. Of each kind one is
0.5 mm below that surface, one 1 mm and one 1.5 mm. The nominal surface is the scene's own, but for the spheres 0.7 mm below the smooth
sphere, and for the bump 0.2 mm below the smooth cylinder.

| path | kind |
|---|---|
| 0, 1, 2 | across the surface at a constant speed: 50, 35 and 20 mm/s |
| 3, 4, 5 | taps at 2, 3 and 4 Hz |
| 6, 7, 8 | 1, 2 and 3 circles, radii 6, 4 and 2.5 mm |
| 9, 10, 11 | like a hand: between random targets with minimum jerk, depths that vary by 30 %, tremor of 8 to 12 Hz: 0.05, 0.075 and 0.1 mm (root mean square on each axis) |

On the two planes speeds, radii and distances are a fifth larger. On the needle they are about half as large along it, narrowed to its width
across it, and depths are a quarter.

Random numbers are those of splitmix64. The strokes like a hand have the seeds {seeds}, the scan has {scan_seed}.

## To cite

"Scored on the standard course of forceshade, version {version}." Scores on the same files can be compared. They are the files of version {version} if

    sha256sum SHA256SUMS

prints {digest}
and `sha256sum -c SHA256SUMS` finds no difference. If it prints another number, cite that number, too.
)";

std::string toml_of(const CourseShape& shape) {
    const std::string head = fmt::format("# {}: {}. Standard course of forceshade, version {}.\n\n", shape.name,
                                         shape.about, kCourseVersion);
    const std::string surface =
        shape.mesh.empty() ? "kind = \"bump\"\nwidth = \"1000 mil\"\nradius = \"600 mil\"\nfacets = 4\n"
                           : fmt::format("kind = \"mesh\"\nfile = \"{}.obj\"\nunit = \"mm\"\nsha256 = \"{}\"\n",
                                         shape.name, sha256_of(shape.mesh));
    return fmt::format("{}[surface]\n{}\n{}", head, surface, shape.keys);
}

std::string readme() {
    std::string table;
    for (const CourseShape& shape : course_shapes())
        table += fmt::format("| `{}` | {} |\n", shape.name, shape.about);
    return fmt::format(
        kReadme, fmt::arg("version", kCourseVersion), fmt::arg("scenes", course_shapes().size()),
        fmt::arg("strokes", kCourseStrokes), fmt::arg("table", table), fmt::arg("digest", kCourseDigest),
        fmt::arg("scan_seed", kCourseScanSeed),
        fmt::arg("seeds", fmt::format("{} to {}", kCourseHandSeed + 9, kCourseHandSeed + kCourseStrokes - 1)));
}

// The same samples with the oracle's forces.
std::string oracle_text(const std::filesystem::path& scene, const std::filesystem::path& positions) {
    CasePreparation preparation;
    const PreparedCase prepared = preparation.prepare(read_scene(scene));
    Yardstick yardstick(prepared);
    std::string text = "path,t,x,y,z,fx,fy,fz\n";
    for (const Stroke& stroke : read_strokes(positions, {}, {}, size_of(prepared)).all) {
        check_interrupt();
        const Truth truth = yardstick.along(stroke);
        for (std::size_t i = 0; i < stroke.probe.size(); ++i) {
            text += fmt::format("{},{:.3f}", stroke.id, stroke.time[i]);
            for (const glm::dvec3& vector : {stroke.probe[i], truth.force[i]})
                for (int axis = 0; axis < 3; ++axis)
                    text += fmt::format(",{}", fixed_decimals(vector[axis], 9));
            text += "\n";
        }
    }
    return text;
}

// The names of the files that the course's SHA-256 is of, sorted.
std::vector<std::string> summed_files() {
    std::vector<std::string> names;
    for (const CourseShape& shape : course_shapes()) {
        const std::string name = shape.name;
        names.insert(names.end(), {name + ".toml", "strokes/" + name + ".csv", "oracle/" + name + ".csv"});
        if (!shape.mesh.empty())
            names.push_back(name + ".obj");
    }
    std::ranges::sort(names);
    return names;
}

} // namespace

std::vector<CourseScene> course() {
    std::vector<CourseScene> scenes;
    for (const CourseShape& shape : course_shapes())
        scenes.push_back({shape.name, toml_of(shape), shape.mesh, course_strokes(shape)});
    return scenes;
}

std::vector<std::filesystem::path> course_files(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> files{folder / "README.md", folder / "SHA256SUMS"};
    for (const std::string& name : summed_files())
        files.push_back(folder / name);
    return files;
}

CourseWritten write_course(const std::filesystem::path& folder) {
    for (const char* const name : {"strokes", "oracle"})
        make_subfolder(folder, name);
    const std::vector<CourseScene> scenes = course();
    Stage stage("the course", scenes.size(), "scenes");
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        const CourseScene& one = scenes[i];
        const std::filesystem::path scene = folder / (one.name + ".toml"),
                                    strokes = folder / "strokes" / (one.name + ".csv");
        if (!one.mesh.empty())
            write_file_atomically(folder / (one.name + ".obj"), one.mesh);
        write_file_atomically(scene, one.toml);
        write_file_atomically(strokes, one.strokes);
        write_file_atomically(folder / "oracle" / (one.name + ".csv"), oracle_text(scene, strokes));
        stage.update(i + 1);
    }
    std::string sums;
    for (const std::string& name : summed_files())
        sums += fmt::format("{}  {}\n", sha256_of_file(folder / name), name);
    write_file_atomically(folder / "SHA256SUMS", sums);
    write_file_atomically(folder / "README.md", readme());
    return {course_files(folder).size(), sha256_of(sums)};
}

} // namespace forceshade::score
