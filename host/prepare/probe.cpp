#include "host/prepare/probe.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "host/error.h"

namespace forceshade {

namespace {

// L1 to L5: no history.
template <typename T> class SurfaceLaw final : public PathLaw<T> {
public:
    explicit SurfaceLaw(const PreparedCase& prepared)
        : tables_(make_tables<T>(prepared.one.scene, prepared.images, Extent::what_varies)), law_(tables_.law()) {}

    double largest_coordinate() const override { return kLargestLength<T>; }

    PathContact<T> at(std::size_t, const glm::dvec3& probe) override {
        PathContact<T> felt;
        felt.contact = reference::evaluate(law_, reference::Vector<T>(probe));
        return felt;
    }

private:
    FieldTables<T> tables_;
    layout::Law<T> law_; // points into the tables
};

// L6 to L9 along paths: the god-object, one for each path.

template <typename T> class MeshPathLaw final : public PathLaw<T> {
public:
    explicit MeshPathLaw(const PreparedCase& prepared)
        : structure_(prepared.images.mesh->structure),
          tables_(make_tables<T>(prepared.one.scene, prepared.images, Extent::what_varies)), law_(tables_.law()) {}

    double largest_coordinate() const override {
        const glm::dvec3& centre = structure_.centre;
        const double middle = std::max({std::abs(centre.x), std::abs(centre.y), std::abs(centre.z)});
        return std::min(kLargestLength<T>, middle + kMeshReach<T> * structure_.scale);
    }

    PathContact<T> at(std::size_t path, const glm::dvec3& probe) override {
        const reference::Vector<T> local = reference::to_mesh_frame(law_.mesh.params, reference::Vector<T>(probe));
        if (!is_within_reach(local))
            throw UsageError(
                fmt::format("path position ({}, {}, {}) m is more than {:.0f} times the mesh's size from its "
                            "centre, further than {} can follow; is the unit right?",
                            probe.x, probe.y, probe.z, kMeshReach<T> / 2, std::is_same_v<T, float> ? "f32" : "f64"));
        bool inside = false;
        if (path == proxies_.size())
            inside = begin_probe(law_, around_, proxies_.emplace_back(), local);
        PathContact<T> felt = follow_probe(law_, around_, proxies_[path], probe, local);
        felt.begins_inside = inside;
        return felt;
    }

private:
    const MeshStructure& structure_;
    FieldTables<T> tables_;
    layout::Law<T> law_; // points into the tables
    reference::Neighbourhood<T> around_;
    std::vector<reference::GodObject<T>> proxies_; // by path
};

} // namespace

template <typename T> std::unique_ptr<PathLaw<T>> make_path_law(const PreparedCase& prepared) {
    if (prepared.one.scene.surface.kind == SurfaceKind::mesh)
        return std::make_unique<MeshPathLaw<T>>(prepared);
    return std::make_unique<SurfaceLaw<T>>(prepared);
}

template std::unique_ptr<PathLaw<float>> make_path_law<float>(const PreparedCase&);
template std::unique_ptr<PathLaw<double>> make_path_law<double>(const PreparedCase&);

} // namespace forceshade
