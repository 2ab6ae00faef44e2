#include "host/explore/path_law.h"

#include <type_traits>

namespace forceshade {
namespace {

// Lengths whose squares and fourth powers' roots stay in range, the same that scenes may have.
template <typename T> constexpr double kLargestLength = std::is_same_v<T, float> ? 1e15 : 1e150; /* m */

// L1 to L5: no history.
template <typename T> class SurfaceLaw final : public PathLaw<T> {
public:
    explicit SurfaceLaw(const PreparedCase& prepared)
        : tables_(make_tables<T>(prepared.one.scene, prepared.images, Extent::what_varies)), law_(tables_.law()) {}

    double largest_coordinate() const override { return kLargestLength<T>; }

    PathContact<T> at(std::size_t, const glm::dvec3& probe) override {
        return {reference::evaluate(law_, {static_cast<T>(probe.x), static_cast<T>(probe.y), static_cast<T>(probe.z)})};
    }

private:
    FieldTables<T> tables_;
    layout::Law<T> law_; // points into the tables
};

} // namespace

template <typename T> std::unique_ptr<PathLaw<T>> make_path_law(const PreparedCase& prepared) {
    return std::make_unique<SurfaceLaw<T>>(prepared);
}

template std::unique_ptr<PathLaw<float>> make_path_law<float>(const PreparedCase&);
template std::unique_ptr<PathLaw<double>> make_path_law<double>(const PreparedCase&);

} // namespace forceshade
