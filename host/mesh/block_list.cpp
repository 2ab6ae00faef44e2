#include "host/mesh/block_list.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "host/mesh/block_loops.h"

namespace forceshade {

using reference::Vector;

namespace {

template <typename T> void grow(std::vector<T>& values, std::size_t count) {
    if (values.size() < count)
        values.resize(count + count / 2);
}

} // namespace

template <typename T> bool is_below(const PlanTriangle<T>& triangle, const PlanBox<T>& box, T slack) {
    const Vector<T>& n = triangle.normal;
    if (n.x == T(0) && n.y == T(0) && n.z == T(0))
        return true;
    const Vector<T> lowest{n.x > T(0) ? box.low.x : box.high.x, n.y > T(0) ? box.low.y : box.high.y,
                           n.z > T(0) ? box.low.z : box.high.z};
    return reference::dot(n, lowest) - triangle.offset > slack;
}

template <typename T>
void TriangleList<T>::fill(std::span<const layout::uint> ids, std::span<const PlanTriangle<T>> rows) {
    ids_.assign(ids.begin(), ids.end());
    for (auto& column : columns_)
        grow(column, ids.size());
    for (std::size_t i = 0; i < ids.size(); ++i) {
        const PlanTriangle<T>& row = rows[ids[i]];
        for (std::size_t c = 0; c < row.corners.size(); ++c)
            columns_[c][i] = row.corners[c];
        columns_.back()[i] = row.circle;
    }
    sample();
}

template <typename T> void TriangleList<T>::take(const TriangleList& all, std::span<const layout::uint> places) {
    const std::size_t count = places.size();
    ids_.resize(count);
    for (std::size_t i = 0; i < count; ++i)
        ids_[i] = all.ids_[places[i]];
    for (std::size_t c = 0; c < columns_.size(); ++c) {
        grow(columns_[c], count);
        const T* const from = all.columns_[c].data(); // one by one: processors' gathering is no faster
        T* const to = columns_[c].data();
        for (std::size_t i = 0; i < count; ++i)
            to[i] = from[places[i]];
    }
    sample();
}

template <typename T>
void TriangleList<T>::narrow(const PlanBox<T>& box, const Witness<T>& witness,
                             std::vector<layout::uint>& places) const {
    const std::size_t count = size();
    scratch_.resize(std::max(scratch_.size(), count));
    const Vector<T> centre = box.centre(), side = box.high - box.low;
    Columns<T> columns;
    for (std::size_t c = 0; c < columns.size(); ++c)
        columns[c] = columns_[c].data();
    const Vector<T> apart = centre - witness.point;
    const T limit = reference::dot(apart, apart) + witness.margin;
    all_excesses(columns, count, centre, side, witness.point, limit, scratch_.data());
    keep(count, places);
}

// The places of all whose excess in scratch_ is not above 0.
template <typename T> void TriangleList<T>::keep(std::size_t count, std::vector<layout::uint>& places) const {
    // What goes mostly goes together: eight marks that are all 0 are passed at once.
    constexpr std::size_t kMarks = sizeof(std::uint64_t);
    marks_.resize(std::max(marks_.size(), count + kMarks));
    mark_kept(scratch_.data(), count, marks_.data());
    std::fill_n(marks_.begin() + std::ptrdiff_t(count), kMarks, std::uint8_t(0));
    places.resize(std::max(places.size(), count + kMarks));
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; i += kMarks) {
        std::uint64_t marks;
        std::memcpy(&marks, &marks_[i], kMarks);
        if (marks == 0)
            continue;
        for (std::size_t k = i; k < i + kMarks; ++k) {
            places[kept] = static_cast<layout::uint>(k);
            kept += marks_[k];
        }
    }
    places.resize(kept);
}

template <typename T> std::array<std::size_t, 8> TriangleList<T>::near_corners(const PlanBox<T>& box) {
    const std::size_t count = size();
    grow(squares_, 8 * count);
    Columns<T> columns;
    for (std::size_t c = 0; c < columns.size(); ++c)
        columns[c] = columns_[c].data();
    all_squares_to_corners(columns, count, box.low, box.high, squares_.data());
    std::array<std::size_t, 8> places;
    for (std::size_t k = 0; k < 8; ++k)
        places[k] = near_least_of(squares_.data() + k * count, count);
    return places;
}

template <typename T>
void TriangleList<T>::narrow_corners(const std::array<T, 8>& limits, std::vector<layout::uint>& places) const {
    scratch_.resize(std::max(scratch_.size(), size()));
    all_beyond_limits(squares_.data(), columns_.back().data(), size(), limits, scratch_.data());
    keep(size(), places);
}

// First corners of every few triangles: each vertex is that of two triangles on average, and large boxes can do with
// fewer. The witness only has to be near.
template <typename T> void TriangleList<T>::sample() {
    constexpr std::size_t kEnough = 128;
    stride_ = std::max<std::size_t>(1, size() / kEnough);
    const std::size_t samples = (size() + stride_ - 1) / stride_;
    for (std::size_t c = 0; c < samples_.size(); ++c) {
        grow(samples_[c], samples);
        for (std::size_t i = 0; i < samples; ++i)
            samples_[c][i] = columns_[c][i * stride_];
    }
}

template <typename T> std::size_t TriangleList<T>::near_one(const Vector<T>& point) const {
    const std::size_t samples = (size() + stride_ - 1) / stride_;
    scratch_.resize(std::max(scratch_.size(), samples));
    all_squares(samples_[0].data(), samples_[1].data(), samples_[2].data(), samples, point, scratch_.data());
    return stride_ * near_least_of(scratch_.data(), samples);
}

template bool is_below(const PlanTriangle<float>&, const PlanBox<float>&, float);
template bool is_below(const PlanTriangle<double>&, const PlanBox<double>&, double);
template class TriangleList<float>;
template class TriangleList<double>;

} // namespace forceshade
