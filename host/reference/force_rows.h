// Forces over an analytic surface, a row of samples along x at a time: the operations of contact_at in its order, so
// the same bits, on as many samples at once as the processor can.
#pragma once

#include <cstddef>
#include <vector>

#include "host/reference/chunks.h"

namespace forceshade::reference {

/// Per-column data, constant in z: 3 numbers a sample, as in the result, or 1.
template <typename T> struct ForceColumns {
    const T *height, *normal, *direction, *texture;     /* 3: m, 1, 1, 1 */
    const T* sideways;                                  /* 3: 1 where a texture may push, else 0 */
    const T *x, *on_bump, *facet_height, *facet_normal; /* 1: m, 0 or 1, m, 1 */
    std::size_t samples;
};

template <typename T> class ForceRows {
public:
    /// True where rows serve: an analytic surface, and no channel but the force is asked for.
    static bool serve(const layout::Features& features) {
        return features.surface != layout::kSurfaceMesh && features.channels == layout::kChannelForce;
    }
    /// Bytes that the columns of a grid take.
    static std::size_t bytes(const layout::FieldInput<T>& input, std::size_t rows);

    /// The columns above input.x and rows of input.y from `first` on.
    void prepare(const layout::FieldInput<T>& input, std::size_t first, std::size_t rows, Crew& crew);
    /// N: 3 numbers a sample of a row of input.y, at height z, m.
    void evaluate(const layout::Law<T>& law, std::size_t y, T z, T* force) const;

private:
    std::vector<T> height_, normal_, sideways_, x_, on_bump_, facet_height_, facet_normal_; // of any row
    std::vector<T> direction_, texture_;                                                    // row by row, or of any row
    std::size_t first_ = 0;
    bool alike_ = true; // all rows are
};

} // namespace forceshade::reference
