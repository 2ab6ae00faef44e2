// How far rounding may take a computed voxel of a mesh from the exact one, and which facets it may have meant.
#pragma once

#include "host/reference/contact.h"
#include "host/validate/reading.h"
#include "host/validate/rounding_bound.h"

namespace forceshade {

/// In the mesh's frame no coordinate exceeds 1, and with u the unit roundoff of the precision and P the probe's largest
/// coordinate, or 1, every distance, offset and proxy is off by at most e = 64 u (1 + P): the longest chain is that of
/// a face, 42 u (1 + P) (host/reference/mesh_nearest.h), and the mesh's vertices and centre are rounded too. Then:
///  - any triangle within 2 e of the nearest may be taken for it, with its own facet, proxy and direction;
///  - a probe within 2 e of the surface may be taken for inside or outside; so may one whose offset is so nearly in the
///  plane of a triangle taken for the nearest that the exact law says otherwise there;
///  - the interpolated normal moves with the proxy: by at most 8 e / (height of the facet) of the length it had before
///  it was normalised, and that length is no less than the least component of a vertex normal along their sum;
///  - a gradient of a height map is taken at a proxy that is off by e: what that changes is looked up on either side.
class MeshBound {
public:
    /// The case must outlive the bound.
    MeshBound(const PreparedCase& prepared, Precision precision);

    enum class Verdict { within, on_edge, beyond };

    /// Whether a reading is the law's at the probe (mesh frame), allowing for the rounding of so many `sides`.
    Verdict judge(const Reading& computed, const reference::Vector<double>& probe, double sides,
                  layout::uint channels) const;

    /// True if rounding, of the probe's position too, decides which point of the mesh an exact force near `probe`
    /// and one computed there belong to: the difference between them then says nothing.
    bool parts(const Triple& computed, const reference::Vector<double>& probe, const Triple& exact) const;

    /// The bound where the law touches a given point of a facet.
    Bound at(const reference::Vector<double>& probe, const reference::MeshTouch<double>& touch) const;

    /// 1: e at a probe.
    double reach(const reference::Vector<double>& probe) const;

    const layout::Law<double>& law() const { return law_; }

private:
    double direction_error(const reference::MeshTouch<double>& touch, double reach) const;
    double slope_error(layout::uint kind, const layout::MapParams<double>& map, std::span<const double> samples,
                       const reference::Vector<double>& world, double reach) const;

    FieldTables<double> tables_;
    layout::Law<double> law_;
    double unit_; // 64 u
    double tiny_; // smallest normal number, four times
};

} // namespace forceshade
