// One side of a comparison, ready to be evaluated again and again: what it takes, and what it gives.
#pragma once

#include <memory>
#include <vector>

#include "host/engine/engine.h"
#include "host/study/omission/comparison.h"

namespace forceshade::study {

struct Cost {
    double kernel = 0;           /* s: on the device; of the CPU oracle all of it */
    double whole = 0;            /* s: planning, tables, kernel and reading back, by the clock */
    std::uint64_t uploaded = 0;  /* bytes: tables, plans, positions */
    std::uint64_t received = 0;  /* bytes of results */
    std::uint64_t evaluated = 0; /* samples */
};

/// All samples of a grid, by z, then y, then x; or of paths, by path, then step. Channels that were not asked for are
/// empty. Where one y stood for all, it stands for all here too.
template <typename T> struct Captured {
    std::vector<T> force, depth, proxy, unshaded, position;
    std::vector<layout::uint> facet;
    std::vector<layout::PathMetrics<T>> metrics; /* of paths */
};

template <typename T> class Side {
public:
    virtual ~Side() = default;
    /// With every result looked at by nobody, unless the setup has the oracle check it.
    virtual Cost measure(Engine& engine) = 0;
    /// With more channels than the setup has.
    virtual Captured<T> capture(Engine& engine, std::uint32_t channels) = 0;
    /// Of the grid, or of all paths.
    virtual std::size_t samples() const = 0;
};

/// `setup` must outlive it; `paths`: those of its scene, not its field.
template <typename T> std::unique_ptr<Side<T>> make_side(const Setup& setup, bool paths);

extern template std::unique_ptr<Side<float>> make_side<float>(const Setup&, bool);
extern template std::unique_ptr<Side<double>> make_side<double>(const Setup&, bool);

} // namespace forceshade::study
