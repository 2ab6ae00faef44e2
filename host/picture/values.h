// What a picture of a field is drawn from: plane slices of a force volume, whole or sub-sampled; a slice as one number
// a sample; and the colours that show it.
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

#include "host/picture/colours.h"

namespace forceshade::picture {

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

/// Force vectors over a slice; (Fx, Fy, Fz) whatever u and v are.
struct FieldSlice {
    SliceAxes axes;
    std::vector<std::array<double, 3>> force; /* N */
};

/// What colours show: |F|, a component, the direction in the plane of the slice, or the angle by which shading turns F.
enum class Quantity { magnitude, x, y, z, direction, angle };

/// As the command line names them, in the order of Quantity.
inline constexpr std::array<std::string_view, 6> kQuantityNames{"magnitude", "x", "y", "z", "direction", "turn"};

/// The value without force; a value that is not finite is NaN.
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

/// What a set of values holds.
struct Census {
    double largest = 0; // of the finite ones, without their sign; 0 without any
    std::size_t samples = 0, none = 0, non_finite = 0;
};

Census take_census(std::span<const double> values);
Census operator+(const Census& a, const Census& b);

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

/// The scale for values up to `largest` in a plane with those directions.
ColourScale scale_for(Quantity quantity, double largest, const std::array<std::size_t, 3>& axis);

/// " (at most 16.8 N)"; empty without values, and for directions.
std::string largest_note(const ColourScale& scale, double largest);

/// The sample nearest to the middle of each of `pixels` equal parts of an axis, from its low end.
std::vector<std::size_t> nearest_samples(const std::vector<double>& samples, double spacing, int pixels);

/// width * height pixels 0x00RRGGBB, row 0 at the largest v; each shows the nearest sample, without interpolation.
std::vector<std::uint32_t> rasterise(const ValueSlice& slice, int width, int height, const ColourScale& scale);

/// Which samples of slices a picture shows: [first, last] along u and v.
struct Window {
    std::size_t u_first = 0, u_last = 0, v_first = 0, v_last = 0;
};

/// Where some slice has a force or NaN, with a border; of `reach` (m: low and high v), if given, all that
/// the slice has. The whole slice without contact.
Window contact_window(std::span<const ValueSlice> slices, std::optional<std::array<double, 2>> reach = {});

ValueSlice cropped(const ValueSlice& slice, const Window& window);
FieldSlice cropped(const FieldSlice& slice, const Window& window);

} // namespace forceshade::picture
