#include "host/explore/path_law.h"

#include "host/explore/mesh_path_law.h"

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

} // namespace

template <typename T> std::unique_ptr<PathLaw<T>> make_path_law(const PreparedCase& prepared) {
    if (prepared.one.scene.surface.kind == SurfaceKind::mesh)
        return std::make_unique<MeshPathLaw<T>>(prepared);
    return std::make_unique<SurfaceLaw<T>>(prepared);
}

template std::unique_ptr<PathLaw<float>> make_path_law<float>(const PreparedCase&);
template std::unique_ptr<PathLaw<double>> make_path_law<double>(const PreparedCase&);

} // namespace forceshade
