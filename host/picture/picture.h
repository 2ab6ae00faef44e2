// Pictures as PNG bytes and vectors: of a force volume slices and arrows, of explored paths, and charts; and their
// files.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "host/output/record.h"
#include "host/picture/values.h"

struct _cairo_surface;

namespace forceshade {
struct Case;
struct Mesh;
struct MeshMarks;
struct PathsSpec;
struct PreparedCase;
struct Scene;
} // namespace forceshade

namespace forceshade::picture {

/// Pixels; (x, y) is the upper left corner.
struct Box {
    double x = 0, y = 0, width = 0, height = 0;
};

struct PlacedText {
    std::string text;
    Box ink; // where its ink lies
};

/// A finished picture. The same input gives the same bytes: the file holds no date and no program version.
struct Picture {
    std::vector<std::uint8_t> png;
    int width = 0, height = 0;     // pixels
    std::vector<PlacedText> texts; // every text drawn, so that a test can see that none overlaps or is cut
    std::shared_ptr<_cairo_surface> drawing;

    /// As vectors; letters are outlines in SVG. \throws std::runtime_error if the drawing library fails (out of
    /// memory).
    std::string svg() const;
    std::string pdf() const;
};

/// What the user may choose of any picture.
struct Look {
    std::string title;     // UTF-8, wrapped if it is long
    int width = 1400;      // pixels; texts keep their size
    int most_height = 0;   // pixels: plots become smaller to keep it, as far as they can; 0: as high as they need
    double full_scale = 0; /* N: where the colours of forces end; 0: at the largest */
    friend bool operator==(const Look&, const Look&) = default;
};

/// A point of a line in the x-z plane.
struct LinePoint {
    double x, z; /* m */
};

/// Lines drawn over a slice, each left out if empty.
struct SurfaceLines {
    std::vector<LinePoint> nominal; // the surface that the depth is measured from, solid
    std::vector<LinePoint> smooth;  // the shape that the shading imitates, dashed
};

/// How deep a hand touches, and the size of the force there.
struct Touch {
    double depth = 0; /* m */
    double force = 0; /* N */
};

/// A quantity over x and y at each z (at least one, increasing; axes x and y common to all), one colour scale for all.
/// Shown are the part of the grid and the slices, at most 12, where there is a force.
Picture draw_mosaic(const Look& look, std::span<const ValueSlice> tiles, Quantity quantity = Quantity::magnitude);

/// A slice: a quantity as colour, the force in the plane as arrows of equal length. They stand at equal steps along the
/// surface, where the force (unshaded, if given) has the size that it has at `touch`; on a grid where it has it
/// nowhere. `lines` are of its own plane, u and v. An angle needs `unshaded`.
Picture draw_arrows(const Look& look, const FieldSlice& slice, const Touch& touch, const SurfaceLines& lines = {},
                    Quantity quantity = Quantity::magnitude, const FieldSlice& unshaded = {});

/// What shading changes: unshaded and shaded force to one scale with arrows at the same places, and the angle between
/// them.
Picture draw_shading(const Look& look, const FieldSlice& unshaded, const FieldSlice& shaded, const Touch& touch,
                     const SurfaceLines& lines = {});

/// A path to draw: sample i was at way[i]; direction[i] is the force's, NaN without force.
struct DrawnPath {
    std::string label;
    std::vector<LinePoint> way;
    std::vector<double> direction; /* deg: in the x-z plane, from z towards x */
};

/// Of all paths about a place: the 5th percentile, the median and the 95th; NaN where they have too few samples.
struct PathBand {
    double x;                           /* m */
    std::array<double, 3> z, direction; /* m, deg */
};

struct PathDrawing {
    Look look;
    std::vector<std::string> notes; // lines below the title
    std::vector<DrawnPath> paths;   // one at least, with a finite sample
    SurfaceLines surface;           // its normals are drawn with the forces' directions
    bool draws_normals = true;
    std::vector<PathBand> bands{}; // beneath the paths, ascending in x; may be empty
};

/// Explored paths over the section of the surface, and below it where the force pointed.
Picture draw_paths(const PathDrawing& drawing);

/// A force on a probe that strokes the surface along x, with and without shading.
struct StrokedForce {
    double x;                      /* m */
    std::array<double, 3> force{}; /* N */
    std::array<double, 3> unshaded{};
};

/// The direction in the x-z plane and both components over x, shaded and unshaded on the same axes; `differs`: unshaded
/// is another force.
Picture draw_stroke(const Look& look, const std::vector<std::string>& notes, std::span<const StrokedForce> forces,
                    bool differs);

/// The normals of a line whose x increases, as a line of its own: x in m, z the angle from z towards x in deg. A
/// segment's normal stands at both its ends.
std::vector<LinePoint> normals_of(const std::vector<LinePoint>& line);

/// m: the x between which paths are drawn, before a border. Paths that are hardly wide, as taps are, are shown as wide
/// as high, so that the surface below them is seen. Without a finite sample low > high.
struct Breadth {
    double low = 0, high = 0;
};
Breadth drawn_breadth(const std::vector<DrawnPath>& paths);

/// A mesh from two opposite sides, with what is remarkable in it marked.
/// Of a mesh with at least one triangle that has an area. Marks are drawn over everything, pale where the mesh hides
/// them. `unit` of lengths: "m", or what else stands in their place.
Picture draw_mesh(const Look& look, const std::vector<std::string>& notes, const Mesh& mesh, const MeshMarks& marks,
                  const std::string& unit = "m");

/// A mesh under one shading, each of its triangles cut into parts * parts equal ones.
struct TurnedMesh {
    std::string shading; // its name
    unsigned parts = 1;
    std::vector<float> turns; /* deg: of the force in the middle of each part, as for_each_part() has them */
};

/// Calls use(corners) for each part: what share of the way to the triangle's second and third corner its corners have.
template <typename Use> void for_each_part(unsigned parts, const Use& use) {
    using Shares = std::array<std::array<double, 2>, 3>;
    const double step = 1.0 / parts;
    for (unsigned row = 0; row < parts; ++row)
        for (unsigned column = 0; column + row < parts; ++column) {
            const double v = column * step, w = row * step;
            use(Shares{{{v, w}, {v + step, w}, {v, w + step}}});
            if (column + row + 1 < parts)
                use(Shares{{{v + step, w}, {v + step, w + step}, {v, w + step}}});
        }
}

/// Where meshes are seen from unless the user says: from the right, in front and above.
inline constexpr std::array<double, 3> kView{0.9, -1.3, 0.8};

/// A mesh under several shadings, at most two side by side, from `view` (a vector towards us, not 0), coloured by how
/// far each turns the force; one scale for all, up to what 99 of 100 parts stay below in each.
Picture draw_turns(const Look& look, const std::vector<std::string>& notes, const Mesh& mesh,
                   std::span<const TurnedMesh> shadings, const std::array<double, 3>& view = kView);

/// Which files of a picture to write.
struct Endings {
    bool png = false, svg = false, pdf = false;
    bool any() const { return png || svg || pdf; }
    /// False if `name` is none of them.
    bool add(std::string_view name);
};

/// "STEM.png" and so on.
std::vector<std::string> names_with(const std::string& stem, const Endings& endings);

/// Writes them, each whole or not at all. \throws IoError.
std::vector<FileRecord> write_picture(const std::filesystem::path& stem, const Endings& endings,
                                      const Picture& picture);

// What a scene says of its pictures: their title, and the outlines over the forces.

/// "Bump of 2 facets, radius 15.2 mm, shaded as its cylinder, stiffness 2 N/mm": the surface, its shading, and whatever
/// else varies in the case's study.
std::string title_of(const Case& one, bool with_shading = true);

/// "100 paths (strokes)".
std::string paths_title(const PathsSpec& paths);

} // namespace forceshade::picture

namespace forceshade {

/// Where a section in the x-z plane lies.
struct SectionSpan {
    double from = 0, to = 0; /* m: x */
    double y = 0;            /* m */
};

/// The surface that depth is measured from, and the shape that shading imitates (empty without shading).
picture::SurfaceLines surface_lines(const PreparedCase& prepared, const SectionSpan& section);
/// The same over the grid.
picture::SurfaceLines surface_lines(const PreparedCase& prepared, double y /* m */);

/// m: 1 mm; on a bump narrower than 20 mm a twentieth of its width, on a thinner mesh of its shortest side.
double pressed_depth(const PreparedCase& prepared);

/// A stroke over the grid at one y, m, with the probe at one depth straight below the surface, where it has one; N, in
/// double precision and without a history.
struct SceneStroke {
    std::vector<picture::StrokedForce> forces;
    double depth = 0; /* m */
};
SceneStroke stroke_of(const PreparedCase& prepared, double y);

} // namespace forceshade
