// What a picture of a field is drawn from: plane slices of a force volume, whole or sub-sampled; a slice as one number
// a sample; the colours that show it; and what collects the slices.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host/scene/scene.h"
#include "shaders/shared/law.h"

namespace forceshade::picture {

// Colours of numbers: maps of d3, as on the report's page, that are read in grey and without red-green vision, but for
// the cyclic one.

/// 8-bit sRGB.
struct Rgb8 {
    std::uint8_t r, g, b;
    friend bool operator==(const Rgb8&, const Rgb8&) = default;
};

/// 0x00RRGGBB.
constexpr std::uint32_t packed(Rgb8 c) {
    return static_cast<std::uint32_t>(c.r << 16 | c.g << 8 | c.b);
}

/// Where the force is zero.
inline constexpr Rgb8 kNoForceColour{255, 255, 255};

/// viridis; plasma, for a second quantity; blue, white, red; a rainbow that begins again where it ends.
enum class ColourMap { sequential, second, diverging, cyclic };

/// The colour at `share` of the map, in [0, 1].
Rgb8 colour_at(ColourMap map, double share);

/// Where the samples of a slice lie: horizontal u and vertical v, increasing; sample (i, j) is number j * u.size() + i.
struct SliceAxes {
    std::vector<double> u; /* m, at least one */
    std::vector<double> v; /* m, at least one */
    double u_spacing = 0;  /* m, of the grid sliced: a sample stands for the cell of this width around it */
    double v_spacing = 0;  /* m */
    double at_spacing = 0; /* m, of the grid along the third axis */
    double at = 0;         /* m: where the slice cuts the third axis */
    std::array<std::size_t, 3> axis{0, 2, 1}; // which of x, y, z are u, v and the third
};

inline constexpr std::array kAxisNames{"x", "y", "z"};

/// Force vectors over a slice; (Fx, Fy, Fz) whatever u and v are. Finite: a volume with other values is refused before
/// its pictures are drawn.
struct FieldSlice {
    SliceAxes axes;
    std::vector<std::array<double, 3>> force; /* N */
};

/// What colours show: |F|, a component, the direction in the plane of the slice, or the angle by which shading turns F.
enum class Quantity { magnitude, x, y, z, direction, angle };

/// As the command line names them, in the order of Quantity.
inline constexpr std::array<std::string_view, 6> kQuantityNames{"magnitude", "x", "y", "z", "direction", "turn"};

/// The value without force.
inline constexpr double kNoForce = -INFINITY;

struct ValueSlice {
    SliceAxes axes;
    std::vector<double> value; /* N, or deg of direction and angle */
};

/// Of one force (N), and of an angle also the unshaded one; `axes` has the directions of the plane. Neither overflows
/// nor vanishes on the way.
double value_of(Quantity quantity, const std::array<double, 3>& force, const std::array<double, 3>& unshaded,
                const std::array<std::size_t, 3>& axis);

/// `unshaded` is used for an angle only.
ValueSlice values_of(const FieldSlice& slice, Quantity quantity, const FieldSlice& unshaded = {});

/// The largest of the values without their signs; 0 without a force.
double largest_of(const ValueSlice& slice);

/// A point on a line of equal force.
struct ContourPoint {
    double u = 0, v = 0;    /* m, from the slice's first sample */
    std::size_t sample = 0; // next to it on the side of larger forces
};

/// The lines on which |F| is `force`, N, linear between samples: along a surface, at the depth of that force. They run
/// with larger forces on one side; closed ones end where they begin.
std::vector<std::vector<ContourPoint>> contours(const FieldSlice& slice, double force);

/// How values become colours.
struct ColourScale {
    Quantity quantity = Quantity::magnitude;
    ColourMap map = ColourMap::sequential;
    double low = 0, high = 0; // equal without values
    std::string words;        // "force magnitude |F|"
    std::string title;        // of its bar: "force magnitude"
    std::string_view unit;    // "N" or "°"

    Rgb8 of(double value) const;
    bool shows() const { return high > low; }
};

/// The scale for values up to `largest` in a plane with those directions; of forces to `full_scale`, N, unless 0.
ColourScale scale_for(Quantity quantity, double largest, const std::array<std::size_t, 3>& axis, double full_scale = 0);

/// " (at most 16.8 N; the colours end at 2 N)"; empty without values, and for directions.
std::string largest_note(const ColourScale& scale, double largest);

/// The sample nearest to the middle of each of `pixels` equal parts of an axis, from its low end.
std::vector<std::size_t> nearest_samples(const std::vector<double>& samples, double spacing, int pixels);

/// width * height pixels 0x00RRGGBB, row 0 at the largest v; each shows the nearest sample, without interpolation.
std::vector<std::uint32_t> rasterise(const ValueSlice& slice, int width, int height, const ColourScale& scale);

/// Which samples of slices a picture shows: [first, last] along u and v.
struct Window {
    std::size_t u_first = 0, u_last = 0, v_first = 0, v_last = 0;
};

/// Where some slice has a force, with a border; of `reach` (m: low and high v), if given, all that the slice has. The
/// whole slice without contact.
Window contact_window(std::span<const ValueSlice> slices, std::optional<std::array<double, 2>> reach = {});

ValueSlice cropped(const ValueSlice& slice, const Window& window);
FieldSlice cropped(const FieldSlice& slice, const Window& window);

// Keeps of a force volume, as its chunks pass by, only what the pictures show: at most 24 MiB, whatever the grid.

inline constexpr std::size_t kMaxSliceSamples = 256; // along one axis of a slice
inline constexpr std::size_t kMaxTiles = 36;

/// `wanted` of `count` indices as evenly as whole numbers allow, first and last among them; all if `count` is no more.
std::vector<std::uint64_t> even_indices(std::uint64_t count, std::size_t wanted);

/// Which slice is kept, and what of the tiles.
struct SliceChoice {
    std::size_t axis = 1;                    // the slice is normal to x, y or z
    std::optional<double> at;                /* m: the sample nearest to it; without: the middle one, rounded down */
    Quantity quantity = Quantity::magnitude; // an angle needs chunks with unshaded forces
};

/// Receives every chunk of a field once, in any order and of any size.
class SliceCollector {
public:
    /// With `repeat_y`, chunks hold the one row y_first = 0, y_count = 1, which stands for every y of the grid.
    SliceCollector(const GridSpec& grid, bool repeat_y, const SliceChoice& choice = {});

    template <typename real> void add(const layout::FieldChunk<real>& chunk); // float or double

    /// F over the chosen slice.
    const FieldSlice& slice() const { return slice_; }
    /// The same of the force without shading; no samples where the chunks have no such channel.
    const FieldSlice& unshaded() const { return unshaded_; }
    /// The quantity over x (u) and y (v) at up to kMaxTiles evenly spaced z, from the lowest z to the highest.
    const std::vector<ValueSlice>& tiles() const { return tiles_; }

private:
    // Samples of the grid in a plane: `axis` as in SliceAxes.
    struct Plane {
        std::array<std::size_t, 3> axis;
        std::vector<std::uint64_t> u, v;
        std::uint64_t at;
    };
    Plane plane(std::size_t normal, std::uint64_t at) const;
    SliceAxes axes_of(const Plane& plane) const;
    template <typename real, typename Keep>
    void visit(const layout::FieldChunk<real>& chunk, const Plane& plane, const Keep& keep) const;

    GridSpec grid_;
    bool repeat_y_;
    SliceChoice choice_;
    Plane plane_;
    FieldSlice slice_, unshaded_;
    std::vector<Plane> tile_planes_;
    std::vector<ValueSlice> tiles_;
};

} // namespace forceshade::picture
