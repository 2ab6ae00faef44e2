#include "host/field/comparison.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include "host/reference/chunks.h"
#include "host/reference/mesh_contact.h"
#include "host/scene/schema.h"

namespace forceshade {

namespace {

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

// deg; of a zero vector, of either, no number.
double angle_between(const glm::dvec3& force, const glm::dvec3& normal) {
    const double length = std::sqrt(reference::dot(force, force));
    if (!(length > 0) || normal == glm::dvec3(0))
        return kNoNumber;
    const glm::dvec3 unit = force / length, difference = unit - normal, sum = unit + normal;
    return 2 * std::atan2(std::sqrt(reference::dot(difference, difference)), std::sqrt(reference::dot(sum, sum))) *
           180 / std::numbers::pi;
}

int axis_of(const CompareSpec& shape) {
    return static_cast<int>(shape.axis.value_or(shape.kind == CompareKind::plane ? CompareAxis::z : CompareAxis::y));
}

} // namespace

bool depends_on_y(const CompareSpec& shape) {
    if (shape.kind == CompareKind::cylinder && !shape.radius) // a bump's own
        return false;
    return shape.kind == CompareKind::sphere || shape.kind == CompareKind::mesh ||
           (shape.kind == CompareKind::plane) == (axis_of(shape) == 1);
}

ShapeComparison::ShapeComparison(const PreparedCase& prepared)
    : kind_(prepared.one.scene.compare->kind), reading_(prepared.one.scene.force.depth),
      stiffness_(prepared.one.scene.force.stiffness), counted_depth_(prepared.one.scene.compare->depth),
      mesh_(prepared.compared_mesh) {
    const CompareSpec& spec = *prepared.one.scene.compare;
    const SurfaceSpec& own = prepared.one.scene.surface;
    axis_ = axis_of(spec);
    radius_ = spec.radius.value_or(own.radius);
    if (kind_ == CompareKind::cylinder && !spec.radius)
        half_width_ = own.width / 2;
    if (spec.centre)
        centre_ = {(*spec.centre)[0], (*spec.centre)[1], (*spec.centre)[2]};
    if (!mesh_)
        return;
    tables_ = make_mesh_tables<double>(mesh_->structure, stiffness_);
    law_.features.surface = layout::kSurfaceMesh;
    law_.features.inside = tables_->winding ? layout::kInsideWinding : layout::kInsidePseudonormal;
    law_.mesh = tables_->view();
}

std::string ShapeComparison::text() const {
    if (half_width_)
        return fmt::format("the bump's own smooth shape (its normal above the probe, depth {}, over the bump)",
                           reading_ == DepthReading::normal ? "along that normal" : "straight down");
    return fmt::format("the {} of [compare] (its normal and depth at the place nearest to the probe)",
                       kCompareKinds[static_cast<std::size_t>(kind_)]);
}

ShapeComparison::Nearest ShapeComparison::nearest(const glm::dvec3& place, layout::uint& hint) const noexcept {
    if (mesh_)
        return nearest_on_mesh(place, hint);
    if (half_width_)
        return above(place);
    glm::dvec3 from = place - centre_;
    if (kind_ == CompareKind::plane) {
        Nearest found{{}, -from[axis_]};
        found.normal[axis_] = 1;
        return found;
    }
    if (kind_ == CompareKind::cylinder)
        from[axis_] = 0;
    const double distance = std::sqrt(reference::dot(from, from));
    return Nearest{distance > 0 ? from / distance : glm::dvec3(0), radius_ - distance};
}

// G1.
ShapeComparison::Nearest ShapeComparison::above(const glm::dvec3& place) const noexcept {
    const double x = place.x, half = *half_width_;
    if (!(std::abs(x) < half))
        return {{0, 0, 1}, -place.z};
    const glm::dvec3 normal(x / radius_, 0, reference::circle_rise(radius_, x) / radius_);
    return {normal, (reference::cylinder_height(half, radius_, x) - place.z) *
                        (reading_ == DepthReading::normal ? normal.z : 1)};
}

ShapeComparison::Nearest ShapeComparison::nearest_on_mesh(const glm::dvec3& place, layout::uint& hint) const noexcept {
    const reference::Vector<double> local(to_mesh_frame(mesh_->structure, place));
    const reference::Nearest<double> found = reference::nearest(law_.mesh, local, hint);
    hint = found.triangle;
    const double distance = std::sqrt(found.square);
    const double side = reference::is_inside(law_, found, local) ? 1 : -1; // of the surface that the offset points to
    const glm::dvec3 normal = distance > 0 ? (side / distance) * found.offset
                                           : reference::vector_at(law_.mesh.triangle_normals, found.triangle);
    return {normal, side * distance * mesh_->structure.scale};
}

Deviation ShapeComparison::at(const glm::dvec3& place, const glm::dvec3& force, layout::uint& hint) const noexcept {
    const double magnitude = std::sqrt(reference::dot(force, force));
    constexpr double kRounding = 1 + 1e-5; // single precision's, so that it decides of no sample at the very depth
    const Nearest found = nearest(place, hint);
    if (!(magnitude > 0 || found.depth > 0))
        return {kNoNumber, kNoNumber, false};
    const bool on_shape = !half_width_ || std::abs(place.x) < *half_width_; // the plane around a bump is no error's
    return {angle_between(force, found.normal), magnitude - stiffness_ * std::max(0.0, found.depth),
            on_shape && (magnitude > 0 ? magnitude / stiffness_ : found.depth) <= kRounding * counted_depth_};
}

void DeviationSum::add(const Deviation& one, double count) {
    if (!one.counts)
        return;
    if (!std::isnan(one.angle)) {
        angles_ += count;
        angle_square_ += count * one.angle * one.angle;
        largest_angle_ = std::max(largest_angle_, one.angle);
    }
    if (!std::isnan(one.magnitude_error)) {
        errors_ += count;
        error_square_ += count * one.magnitude_error * one.magnitude_error;
        largest_error_ = std::max(largest_error_, std::abs(one.magnitude_error));
    }
}

void DeviationSum::add(const DeviationSum& other) {
    angles_ += other.angles_;
    angle_square_ += other.angle_square_;
    largest_angle_ = std::max(largest_angle_, other.largest_angle_);
    errors_ += other.errors_;
    error_square_ += other.error_square_;
    largest_error_ = std::max(largest_error_, other.largest_error_);
}

DeviationRecord DeviationSum::record() const {
    const auto rms = [](double square, double count) { return count > 0 ? std::sqrt(square / count) : 0; };
    return {.angles = static_cast<std::uint64_t>(angles_),
            .rms_angle = rms(angle_square_, angles_),
            .largest_angle = largest_angle_,
            .magnitudes = static_cast<std::uint64_t>(errors_),
            .rms_magnitude_error = rms(error_square_, errors_),
            .largest_magnitude_error = largest_error_};
}

DeviationRecord Compared::record() const {
    DeviationRecord record = sum_.record();
    record.from = comparison_.text();
    record.depth = comparison_.counted_depth();
    return record;
}

Compared::Compared(const PreparedCase& prepared, unsigned threads)
    : comparison_(prepared), by_y_(depends_on_y(*prepared.one.scene.compare)), grid_(prepared.one.scene.grid),
      origin_(scene_origin(prepared)), threads_(reference::threads_for(threads)) {}

// Each sample stands for `count`. Sums by rows, added in their order, so that they do not depend on the threads.
template <typename T, typename PlaceAt>
void Compared::compare(std::size_t rows, std::size_t pitch, std::span<const T> force, double count,
                       const PlaceAt& place_at) {
    Buffers<T>& to = buffers<T>();
    to.angle.assign(rows * pitch, static_cast<T>(kNoNumber));
    to.magnitude_error.assign(rows * pitch, static_cast<T>(kNoNumber));
    std::vector<DeviationSum> sums(rows);
    reference::share_out(threads_, rows, [&](std::size_t, std::size_t row) {
        layout::uint hint = 0;
        for (std::size_t i = row * pitch; i < (row + 1) * pitch; ++i) {
            const std::optional<glm::dvec3> place = place_at(row, i - row * pitch);
            if (!place)
                break;
            const Deviation one = comparison_.at(*place, glm::dvec3(reference::vector_at(force, i)), hint);
            to.angle[i] = static_cast<T>(one.angle);
            to.magnitude_error[i] = static_cast<T>(one.magnitude_error);
            sums[row].add(one, count);
        }
    });
    for (const DeviationSum& one : sums)
        sum_.add(one);
}

// The one row of a layer, once for each of `rows`.
template <typename T>
void Compared::write_out(const layout::FieldChunk<T>& from, std::size_t layer, layout::FieldChunk<T>& rows) {
    Buffers<T>& to = buffers<T>();
    const auto repeat = [&]<typename Value>(std::span<const Value> values, std::size_t components,
                                            std::vector<Value>& into) -> std::span<const Value> {
        into.clear();
        if (values.empty())
            return {};
        const auto row = values.subspan(layer * from.x_pitch * components, from.x_count * components);
        for (std::size_t i = 0; i < rows.y_count; ++i)
            into.insert(into.end(), row.begin(), row.end());
        return into;
    };
    rows.force = repeat(from.force, 3, to.force);
    rows.depth = repeat(from.depth, 1, to.depth);
    rows.unshaded = repeat(from.unshaded, 3, to.unshaded);
    rows.facet = repeat(from.facet, 1, to.facet);
}

template <typename T> void Compared::add_channels(layout::FieldChunk<T>& chunk, std::size_t repeat_y) {
    compare<T>(chunk.y_count * chunk.z_count, chunk.x_pitch, chunk.force, static_cast<double>(repeat_y),
               [&](std::size_t row, std::size_t i) -> std::optional<glm::dvec3> {
                   if (i >= chunk.x_count)
                       return std::nullopt;
                   return glm::dvec3(grid_.at(0, i), grid_.at(1, chunk.y_first + row % chunk.y_count),
                                     grid_.at(2, chunk.z_first + row / chunk.y_count));
               });
    chunk.angle = buffers<T>().angle;
    chunk.magnitude_error = buffers<T>().magnitude_error;
}

template <typename T>
void Compared::field(const layout::FieldChunk<T>& chunk, std::size_t repeat_y, const TakeField<T>& take) {
    if (repeat_y == 1 || !by_y_) {
        layout::FieldChunk<T> compared = chunk;
        add_channels(compared, repeat_y);
        return take(compared, repeat_y);
    }
    constexpr std::size_t kSamples = std::size_t(1) << 20; // at once
    const std::size_t rows_at_once = std::max<std::size_t>(1, kSamples / chunk.x_count);
    for (std::size_t layer = 0; layer < chunk.z_count; ++layer)
        for (std::size_t y = 0; y < repeat_y; y += rows_at_once) {
            layout::FieldChunk<T> rows{};
            rows.x_count = rows.x_pitch = chunk.x_count;
            rows.y_first = y;
            rows.y_count = std::min(rows_at_once, repeat_y - y);
            rows.z_first = chunk.z_first + layer;
            rows.z_count = 1;
            write_out(chunk, layer, rows); // but proxies: where there are some, every y has rows of its own
            add_channels(rows, 1);
            take(rows, 1);
        }
}

template <typename T> PathRows<T> Compared::paths(PathRows<T> rows) {
    compare<T>(rows.path_count, rows.pitch, rows.force, 1,
               [&](std::size_t path, std::size_t i) -> std::optional<glm::dvec3> {
                   if (i >= rows.samples(path))
                       return std::nullopt;
                   return world_place(glm::dvec3(reference::vector_at(rows.position, path * rows.pitch + i)), origin_);
               });
    rows.angle = buffers<T>().angle;
    rows.magnitude_error = buffers<T>().magnitude_error;
    return rows;
}

template void Compared::field(const layout::FieldChunk<float>&, std::size_t, const TakeField<float>&);
template void Compared::field(const layout::FieldChunk<double>&, std::size_t, const TakeField<double>&);
template PathRows<float> Compared::paths(PathRows<float>);
template PathRows<double> Compared::paths(PathRows<double>);

} // namespace forceshade
