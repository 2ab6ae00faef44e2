// How far a scene's forces are from those that the shape of [compare] would give.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include <glm/vec3.hpp>

#include "host/field/prepared_case.h"
#include "host/output/record.h"
#include "host/output/rows.h"

namespace forceshade {

/// The channels that the files of a scene have: force, those it asks for, and with [compare] those of Compared.
inline std::uint32_t written_channels(const Scene& scene) {
    return scene.output.channels | layout::kChannelForce | (scene.compare ? kComparedChannels : 0);
}

/// Difference of a force from the shape's force at the same probe: K times the depth below its nearest place, along
/// the normal there. Of a bump's own smooth shape the place is the one above the probe (L4), and the depth is read as
/// the scene reads its own: straight down, or along that normal.
struct Deviation {
    double angle;           /* deg: between the force and that normal; NaN where one of them is missing */
    double magnitude_error; /* N: |F| - K depth; NaN out of contact with both */
    bool counts;            /* contact at most compare.depth deep; or, without contact, the shape would have it; of a
                               bump's own shape not over the plane around it */
};

/// Whether the shape differs from one y to another.
bool depends_on_y(const CompareSpec& shape);

/// Evaluates in double. Immutable, so threads may share it.
class ShapeComparison {
public:
    /// Of a scene with [compare]. \throws UsageError for a mesh beyond the range of double.
    explicit ShapeComparison(const PreparedCase& prepared);

    /// At a place, m, where the force is `force`, N. `hint`: the triangle nearest to the last place, 0 at first.
    Deviation at(const glm::dvec3& place, const glm::dvec3& force, layout::uint& hint) const noexcept;

    /// "the bump's own smooth shape (its normal above the probe, depth straight down, over the bump)": what a force is
    /// compared with.
    std::string text() const;

    /// m: contact counts up to here.
    double counted_depth() const { return counted_depth_; }

private:
    struct Nearest {
        glm::dvec3 normal{}; // 0 in the middle of a sphere or cylinder
        double depth;        /* m; negative above the shape */
    };
    Nearest nearest(const glm::dvec3& place, layout::uint& hint) const noexcept;
    Nearest above(const glm::dvec3& place) const noexcept; // on a bump's own smooth shape
    Nearest nearest_on_mesh(const glm::dvec3& place, layout::uint& hint) const noexcept;

    CompareKind kind_;
    DepthReading reading_;
    double stiffness_;                   /* N/m */
    double counted_depth_;               /* m */
    double radius_ = 0;                  /* m */
    std::optional<double> half_width_{}; /* m: of a bump, whose own smooth shape this is */
    glm::dvec3 centre_{};                /* m */
    int axis_ = 0;
    std::shared_ptr<const SceneMesh> mesh_; // null: an analytic shape
    std::optional<MeshTables<double>> tables_;
    layout::Law<double> law_; // points into them
};

/// Deviations added up.
class DeviationSum {
public:
    /// One that stands for `count` samples.
    void add(const Deviation& one, double count = 1);
    void add(const DeviationSum& other);
    DeviationRecord record() const;

private:
    double angles_ = 0, angle_square_ = 0, largest_angle_ = 0; /* how many, deg^2, deg */
    double errors_ = 0, error_square_ = 0, largest_error_ = 0; /* how many, N^2, N */
};

/// The channels kChannelAngle and kChannelMagnitudeError of fields and paths, and their totals. T: float, double.
class Compared {
public:
    /// `threads` share the rows out.
    Compared(const PreparedCase& prepared, unsigned threads);

    template <typename T> using TakeField = std::function<void(const layout::FieldChunk<T>&, std::size_t repeat_y)>;
    /// Hands on a chunk of the scene's field with these channels; part by part and written out, where its rows stand
    /// for `repeat_y` ones in which the shape differs.
    template <typename T>
    void field(const layout::FieldChunk<T>& chunk, std::size_t repeat_y, const TakeField<T>& take);
    /// Rows of paths with these channels, whose spans live until the next call.
    template <typename T> PathRows<T> paths(PathRows<T> rows);

    DeviationRecord record() const;

private:
    template <typename T> struct Buffers {
        std::vector<T> angle, magnitude_error, force, depth, unshaded;
        std::vector<layout::uint> facet;
    };
    template <typename T> Buffers<T>& buffers() { return std::get<Buffers<T>>(buffers_); }

    template <typename T, typename PlaceAt>
    void compare(std::size_t rows, std::size_t pitch, std::span<const T> force, double count, const PlaceAt& place_at);
    template <typename T> void add_channels(layout::FieldChunk<T>& chunk, std::size_t repeat_y);
    template <typename T>
    void write_out(const layout::FieldChunk<T>& from, std::size_t layer, layout::FieldChunk<T>& rows);

    ShapeComparison comparison_;
    bool by_y_;
    GridSpec grid_;
    glm::dvec3 origin_; /* m, in the world: of the places of paths */
    unsigned threads_;
    std::tuple<Buffers<float>, Buffers<double>> buffers_; // those of the run's precision are used
    DeviationSum sum_;
};

} // namespace forceshade
