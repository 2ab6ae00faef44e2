#include "host/study/omission/row_paths.h"

namespace forceshade::study {

template <typename T> RowPaths<T>::RowPaths(const FieldTables<T>& tables) : tables_(tables) {}

template <typename T> layout::PathInput<T> RowPaths<T>::input() {
    layout::PathInput<T> input;
    input.law = tables_.law();
    input.features.motion = layout::kMotionRecorded;
    input.features.channels = layout::kChannelForce;
    input.paths = rows();
    input.steps = tables_.x.size();
    input.source = this;
    return input;
}

template <typename T> layout::PathBatch<T> RowPaths<T>::batch(std::size_t first, std::size_t count) {
    first_ = first;
    count_ = count;
    proxies_.clear();
    for (std::size_t row = first; row < first + count; ++row)
        proxies_.push_back(
            {tables_.x.front(), tables_.y[row % tables_.y.size()], tables_.z[row / tables_.y.size()], 0});
    steps_.assign(count, static_cast<layout::uint>(tables_.x.size()));
    layout::PathBatch<T> batch;
    batch.first = first;
    batch.count = count;
    batch.steps = steps_;
    batch.proxies = proxies_;
    batch.longest = tables_.x.size();
    return batch;
}

template <typename T> std::span<const T> RowPaths<T>::positions(std::size_t step, std::size_t steps) {
    const layout::MeshParams<T> frame = tables_.law().mesh.params;
    positions_.clear();
    for (std::size_t i = step; i < step + steps; ++i)
        for (std::size_t row = first_; row < first_ + count_; ++row) {
            positions_.push_back(tables_.x[i] * frame.scale + frame.centre_x);
            positions_.push_back(tables_.y[row % tables_.y.size()] * frame.scale + frame.centre_y);
            positions_.push_back(tables_.z[row / tables_.y.size()] * frame.scale + frame.centre_z);
        }
    return positions_;
}

template class RowPaths<float>;
template class RowPaths<double>;

} // namespace forceshade::study
