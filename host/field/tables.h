// A scene as the laws read it: facets of a bump (G2), gradients of a height map (G3), the arrays of a mesh, in T.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "host/mesh/structure.h"
#include "host/scene/scene.h"
#include "shaders/shared/law.h"

namespace forceshade {

/// The n + 1 x coordinates, m, of the vertices of an n-facet bump, from -a to a exactly, symmetric, not decreasing.
/// Computed in double and rounded once to T. `half_width` is a, `radius` R >= a, both in m.
template <typename T>
std::vector<T> facet_vertices(std::uint32_t facets, double half_width, double radius, FacetSpacing spacing);

/// The steepest gradient: its square is a normal number of T. The scene's check has the same limit for analytic maps.
template <typename T> inline constexpr double kSteepestGradient = sizeof(T) == 4 ? kSteepestF32 : kSteepestF64;

/// (dU/dx, dU/dy) pairs of a grid of samples that spans size_x by size_y metres between its outermost nodes. `samples`
/// are of 1 = `height` metres, rows * columns, row 0 at the largest y (image order); the result has row 0 at the
/// smallest y. Central differences, one-sided at the border; 0 along an axis of a single sample. Computed in double and
/// rounded once to T. \throws UsageError that names `file`, row and column of the image if a gradient is steeper than
/// kSteepestGradient<T> or no number.
template <typename T>
std::vector<T> map_gradients(std::span<const double> samples, std::size_t columns, std::size_t rows, double size_x,
                             double size_y, double height, const std::string& file);

// A scene made ready to evaluate: every table a law reads, rounded once from double to the run's precision.

struct HeightImage;
struct SceneMesh;

/// The images and the mesh that a scene names; null where it names none.
struct SceneImages {
    std::shared_ptr<const HeightImage> map, texture;
    std::shared_ptr<const SceneMesh> mesh;
};

/// Owns the data of a layout::FieldInput.
template <typename T> struct FieldTables {
    layout::Features features;
    layout::LawParams<T> params{};
    std::vector<T> facet_vertices, map_gradients, texture_gradients;
    std::shared_ptr<const MeshTables<T>> mesh;
    std::vector<T> x, y, z; /* m; of a mesh in its own frame */

    layout::Law<T> law() const {
        layout::Law<T> law{features, params, facet_vertices, map_gradients, texture_gradients};
        if (mesh)
            law.mesh = mesh->view();
        return law;
    }
    layout::FieldInput<T> input() const { return {law(), x, y, z}; }
};

/// How much of a grid is evaluated.
enum class Extent {
    nothing,     /* the law alone */
    what_varies, /* one y where the force does not depend on it */
    everything,
};

/// \throws UsageError if a value leaves the range of T, or an image rises too steeply for it.
template <typename T> FieldTables<T> make_tables(const Scene& scene, const SceneImages& images, Extent extent);

/// Makes the updates of god-objects on the tables' mesh faster (MeshObstacles). Takes as long as several updates a
/// triangle; laws made before do not see it.
template <typename T> void find_obstacles(FieldTables<T>& tables);

/// The features of a scene (layout::Features).
layout::Features features_of(const Scene& scene);

/// True if any channel depends on y, so that a grid must be evaluated at every y.
bool depends_on_y(const layout::Features& features);

/// The features left out of the kernel and why, one short phrase each, for the manifest and the volume's attributes.
std::vector<std::string> omissions(const Scene& scene);

} // namespace forceshade
