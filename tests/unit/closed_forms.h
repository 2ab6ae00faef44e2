// Work round a loop over half a bump in closed form: out below the nominal surface from x = 0 to x1 at depth d1, back
// at depth d2.
#pragma once

#include <span>

namespace forceshade::study {

struct BumpLoop {
    double stiffness; /* K, N/m */
    double radius;    /* R, m */
    double end;       /* x1, m: less than a */
    double out, back; /* d1, d2, m: vertical depths */
};

/// The flat shaded plane (L4 with one facet, L5 of a cylinder): K (d1 - d2) x1^2 / (2 R) + K/2 (d1^2 - d2^2) (N_z(x1) -
/// 1), J.
double shaded_plane_work(const BumpLoop& loop);

/// The plane with `two_pass` shading of the cylinder's normals: K (d1 - d2) (U(0) - U(x1)), J.
double two_pass_plane_work(const BumpLoop& loop);

/// n facets with ascending vertices (m), unshaded: every break gives K/2 (c_R - c_L) (d1^2 - d2^2), c the cosine of the
/// slope, or its square where depth is read along the normal, J. Vertices outside [0, x1] count for nothing.
double faceted_work(const BumpLoop& loop, std::span<const double> vertices, bool normal_depth);

/// The same facets, shaded by the cylinder's normal above the probe, J: on a facet of slope s with c as above (1 for
/// vertical depth) the integral of K (d1 - d2) c (N_x + s N_z) dx, and K/2 (d1^2 - d2^2) c N_z at both ends.
double shaded_facets_work(const BumpLoop& loop, std::span<const double> vertices, bool normal_depth);

} // namespace forceshade::study
