// The rows of a mesh's grid as paths: a probe that remembers goes where the static field is sampled.
#pragma once

#include "host/prepare/tables.h"

namespace forceshade::study {

/// One path a row, in the order of rows (z, then y), its steps along x. Each must begin outside of the mesh.
template <typename T> class RowPaths final : public layout::PathSource<T> {
public:
    /// `tables`, of a mesh, must outlive it.
    explicit RowPaths(const FieldTables<T>& tables);

    /// Points to this; force is its channel.
    layout::PathInput<T> input();

    layout::PathBatch<T> batch(std::size_t first, std::size_t count) override;
    std::span<const T> positions(std::size_t step, std::size_t steps) override;

private:
    std::size_t rows() const { return tables_.y.size() * tables_.z.size(); }

    const FieldTables<T>& tables_;
    std::size_t first_ = 0, count_ = 0; // of the batch
    std::vector<layout::ProxyStart<T>> proxies_;
    std::vector<layout::uint> steps_;
    std::vector<T> positions_; // m
};

extern template class RowPaths<float>;
extern template class RowPaths<double>;

} // namespace forceshade::study
