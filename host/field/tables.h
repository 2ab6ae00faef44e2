// A scene made ready to evaluate: every table a law reads, rounded once from double to the run's precision.
#pragma once

#include <memory>
#include <vector>

#include "host/mesh/structure.h"
#include "host/scene/scene.h"
#include "shaders/shared/layout.h"

namespace forceshade {

struct HeightImage;
struct SceneMesh;

/// The images and the mesh that a scene names; null where it names none.
struct SceneImages {
    std::shared_ptr<const HeightImage> map, texture;
    std::shared_ptr<const SceneMesh> mesh;
};

/// Owns what a layout::FieldInput only points to.
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
    what_varies, /* one y where the force does not depend on it */
    everything,
};

/// \throws UsageError if a value leaves the range of T, or an image rises too steeply for it.
template <typename T> FieldTables<T> make_tables(const Scene& scene, const SceneImages& images, Extent extent);

/// What a scene switches on (layout::Features).
layout::Features features_of(const Scene& scene);

/// True if any channel depends on y, so that a grid must be evaluated at every y.
bool depends_on_y(const layout::Features& features);

/// What was left out of the kernel and why, one short phrase each, for the manifest and the volume's attributes.
std::vector<std::string> omissions(const Scene& scene);

extern template FieldTables<float> make_tables<float>(const Scene&, const SceneImages&, Extent);
extern template FieldTables<double> make_tables<double>(const Scene&, const SceneImages&, Extent);

} // namespace forceshade
