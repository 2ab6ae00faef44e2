// L6: the sieve in single precision lets no triangle pass unseen whose plane a move comes close to, and leaves out what
// is far.
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "host/reference/mesh_neighbourhood.h"

namespace forceshade {
namespace {

using reference::CloseTriangles;
using reference::cross;
using reference::dot;
using reference::Move;
using reference::MoveBox;
using reference::Vector;

template <typename T> class Sieve : public ::testing::Test {
protected:
    double share() { return std::uniform_real_distribution<double>(0.0, 1.0)(random_); }

    /// From least to most, over all magnitudes between.
    T size(double least, double most) { return T(least * std::pow(most / least, share())); }

    Vector<T> direction() {
        std::normal_distribution<double> normal;
        return reference::normalised(Vector<T>(T(normal(random_)), T(normal(random_)), T(normal(random_))));
    }

    MoveBox box() {
        MoveBox box;
        const T half = size(0x1p-18, 0.25);
        for (int i = 0; i < 3; ++i) {
            const T middle = T(3.5 * share() - 1.75);
            box.low[i] = static_cast<float>(middle - half * T(0.25 + share()));
            box.high[i] = static_cast<float>(middle + half * T(0.25 + share()));
        }
        return box;
    }

    Vector<T> within(const MoveBox& box) {
        Vector<T> place;
        for (int i = 0; i < 3; ++i)
            place[i] = T(box.low[i]) + T(share()) * (T(box.high[i]) - T(box.low[i]));
        return place;
    }

    /// A triangle (of which only the first corner matters) whose plane passes close to the place, or not so close.
    void add_triangle(const Vector<T>& place) {
        const Vector<T> normal = direction();
        const Vector<T> along = reference::normalised(Vector<T>(cross(normal, direction())));
        const T height = size(0.5 * double(reference::Skin<T>::kWidth), 0.25) * (share() < 0.5 ? T(-1) : T(1));
        const Vector<T> corner = place + height * normal + size(0x1p-20, 4.0) * along;
        for (int i = 0; i < 3; ++i) {
            normals_.push_back(normal[i]);
            vertices_.push_back(corner[i]);
        }
        corners_.insert(corners_.end(), 3, static_cast<layout::uint>(facets_.size()));
        facets_.push_back(static_cast<layout::uint>(facets_.size()));
    }

    layout::MeshView<T> mesh() const {
        layout::MeshView<T> mesh;
        mesh.vertices = vertices_;
        mesh.triangle_corners = mesh.triangle_neighbours = corners_;
        mesh.triangle_facets = facets_;
        mesh.triangle_normals = normals_;
        return mesh;
    }

    void forget() {
        normals_.clear();
        vertices_.clear();
        corners_.clear();
        facets_.clear();
    }

private:
    std::mt19937_64 random_{7};
    std::vector<T> vertices_, normals_;
    std::vector<layout::uint> corners_, facets_;
};

using Precisions = ::testing::Types<float, double>;
TYPED_TEST_SUITE(Sieve, Precisions);

TYPED_TEST(Sieve, MissesNoPlaneAndLeavesOutWhatIsFar) {
    using T = TypeParam;
    std::size_t near = 0, far = 0, missed = 0, cleared = 0, passed = 0;
    auto close = std::make_unique<CloseTriangles<T>>();
    for (layout::uint round = 0; round < 50000; ++round) {
        const MoveBox box = this->box();
        Move<T> move{this->within(box), {}, T(1)};
        const Vector<T> to = this->within(box), way = to - move.from;
        // Moves that are cut keep their way.
        move.until = round % 2 == 0 ? T(1) : T(0.125);
        move.displacement = way / move.until;
        this->forget();
        const layout::uint count = 1 + round % CloseTriangles<T>::kMost;
        for (layout::uint i = 0; i < count; ++i)
            this->add_triangle(i % 2 == 0 ? move.from : to);
        const layout::MeshView<T> mesh = this->mesh();
        close->begin(box);
        for (layout::uint i = 0; i < count; i += 3)
            ASSERT_TRUE(add_close(mesh, i, std::min(i + 3, count), *close));
        complete_row(*close);
        layout::uint left[CloseTriangles<T>::kMost];
        const layout::uint found = sift(*close, move, left);
        layout::uint next = 0;
        for (layout::uint i = 0; i < count; ++i) {
            const bool seen = next < found && left[next] == i;
            next += seen ? 1 : 0;
            const reference::Triangle<T> triangle = reference::triangle_at(mesh, i);
            const bool apart = is_off_plane(triangle, move);
            (apart ? far : near) += 1;
            missed += !apart && !seen ? 1 : 0;
            const T from = dot(triangle.normal, move.from - triangle.corners[0]);
            const T end = dot(triangle.normal, to - triangle.corners[0]);
            const bool clear = from * end > T(0) && std::min(std::abs(from), std::abs(end)) > T(2) * T(close->margin);
            cleared += clear ? 1 : 0;
            passed += clear && seen ? 1 : 0;
        }
        EXPECT_EQ(next, found) << "each at most once, in their order";
    }
    EXPECT_EQ(missed, 0U);
    EXPECT_GT(near, 100000U);
    EXPECT_GT(far, 100000U);
    EXPECT_GT(cleared, 100000U);
    EXPECT_EQ(passed, 0U) << "far above, or below, all along";
}

TYPED_TEST(Sieve, HasRoomForSoManyAndNoMore) {
    auto close = std::make_unique<CloseTriangles<TypeParam>>();
    const MoveBox box = this->box();
    for (layout::uint i = 0; i <= CloseTriangles<TypeParam>::kMost; ++i)
        this->add_triangle(this->within(box));
    close->begin(box);
    EXPECT_TRUE(add_close(this->mesh(), 0, CloseTriangles<TypeParam>::kMost, *close));
    EXPECT_FALSE(
        add_close(this->mesh(), CloseTriangles<TypeParam>::kMost, CloseTriangles<TypeParam>::kMost + 1, *close));
}

} // namespace
} // namespace forceshade
