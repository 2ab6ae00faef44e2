// How far a surface keeps from itself.
#pragma once

#include <memory>
#include <mutex>

#include "host/mesh/structure.h"

namespace forceshade {

/// 1, of the mesh's frame.
constexpr double kLeastGap = 0x1p-14;

/// Whether a surface keeps kLeastGap from itself. Only who needs it first finds out, since that takes as long as a
/// tenth of a field.
class Clearance {
public:
    Clearance(std::shared_ptr<const MeshParts> parts, std::shared_ptr<const MeshReals<double>> reals);
    /// Of a surface of which it is known.
    explicit Clearance(bool is_enough);

    /// Whether triangles without a common corner are further than kLeastGap from each other, and none of those with one
    /// face each other across a sharp slit: no rounding takes one wall for another. Not if in doubt, or if very many
    /// come near each other. Any thread may ask.
    bool is_enough(unsigned threads = 0) const;

private:
    std::shared_ptr<const MeshParts> parts_;
    std::shared_ptr<const MeshReals<double>> reals_;
    mutable std::once_flag once_;
    mutable bool is_enough_ = false;
};

} // namespace forceshade
