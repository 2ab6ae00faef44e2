#include "tests/gpu/random_scene.h"

#include <array>
#include <memory>
#include <random>
#include <string>

#include <fmt/format.h>

#include "host/output/height_image.h"

namespace forceshade::test {
namespace {

using Image = std::shared_ptr<const HeightImage>;

// Own distributions: the standard fixes the engine's sequence, but not what its distributions make of it. For the same
// reason no statement draws two numbers in an order that the compiler may choose.
class Draw {
public:
    explicit Draw(std::uint64_t seed) : engine_(seed) {}

    std::uint64_t below(std::uint64_t limit) { return engine_() % limit; }
    bool one_in(std::uint64_t n) { return below(n) == 0; }
    double uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
    double between(double low, double high) { return low + (high - low) * uniform(); }
    /// A number of any size from 10^low to 10^high, without the C library's powers, whose last bit varies.
    double of_size(int low, int high) {
        double value = 1 + 9 * uniform();
        const int exponent = low + static_cast<int>(below(static_cast<std::uint64_t>(high - low)));
        for (int i = 0; i < std::abs(exponent); ++i)
            value = exponent < 0 ? value / 10 : value * 10;
        return value;
    }
    template <std::size_t n> const char* any(const std::array<const char*, n>& of) { return of[below(n)]; }

private:
    std::mt19937_64 engine_;
};

class Maker {
public:
    Maker(std::uint64_t seed, bool wild) : draw_(seed), wild_(wild) {}

    PreparedCase make() {
        PreparedCase prepared;
        surface(prepared.images.map);
        force();
        if (!draw_.one_in(3))
            texture(prepared.images.texture);
        grid();
        channels();
        prepared.scene = text_;
        prepared.one = parse_scene(text_, "random scene");
        return prepared;
    }

private:
    enum class Kind { bump, cylinder_bump, height_map };

    void table(const char* name) { text_ += fmt::format("[{}]\n", name); }
    void word(const char* key, const std::string& value) { text_ += fmt::format("{} = \"{}\"\n", key, value); }
    void length(const char* key, double metres) { text_ += fmt::format("{} = \"{} m\"\n", key, metres); }
    void stiffness(double value) { text_ += fmt::format("stiffness = \"{} N/m\"\n", value); }
    void lengths(const char* key, std::span<const double> metres) {
        text_ += fmt::format("{} = [\"{} m\"]\n", key, fmt::join(metres, " m\", \""));
    }

    // R / a
    double ratio() {
        if (!wild_)
            return draw_.one_in(2) ? draw_.between(1.01, 3) : 1.01 * draw_.of_size(0, 2);
        switch (draw_.below(4)) {
        case 0:
            return 1;
        case 1:
            return 1 + draw_.of_size(-15, -1);
        case 2:
            return draw_.between(1, 3);
        default:
            return draw_.of_size(0, 9);
        }
    }

    std::uint64_t facets() {
        if (draw_.one_in(4))
            return 1 + draw_.below(3);
        if (!wild_)
            return 1 + draw_.below(100);
        return draw_.one_in(32) ? 1000000 : static_cast<std::uint64_t>(draw_.of_size(0, 6));
    }

    void circle(double width) {
        length("width", width);
        length("radius", width / 2 * ratio());
    }

    void map(Image& image) {
        static constexpr std::array<const char*, 5> kFunctions{"cylinder", "dip", "sine", "gaussian", "file"};
        const std::string function = draw_.any(kFunctions);
        const double across = width_ * (draw_.one_in(2) ? 1 : draw_.between(0.1, 2));
        if (function == "file") {
            image = random_image();
            word("file", "random.png");
            lengths("size", std::array{across, across * draw_.between(0.3, 2)});
        } else {
            word("function", function);
        }
        if (function == "cylinder" || function == "dip")
            return circle(across);
        length("height", across * draw_.between(-0.5, 0.5));
        if (function == "sine")
            length("width", across);
        if (function == "gaussian")
            length("radius", across / 2);
    }

    Image random_image() {
        const auto image = std::make_shared<HeightImage>();
        image->columns = draw_.one_in(8) ? 1 : 1 + draw_.below(64);
        image->rows = draw_.one_in(8) ? 1 : 1 + draw_.below(64);
        const double flatness = draw_.uniform();
        for (std::size_t i = 0; i < image->columns * image->rows; ++i)
            image->samples.push_back(draw_.one_in(4) ? 0 : flatness + (1 - flatness) * draw_.uniform());
        return image;
    }

    void surface(Image& image) {
        static constexpr std::array<const char*, 2> kSpacings{"equal_arc", "equal_x"};
        static constexpr std::array<const char*, 3> kNames{"bump", "cylinder_bump", "height_map"};
        kind_ = draw_.one_in(5) ? Kind::cylinder_bump : draw_.one_in(2) ? Kind::bump : Kind::height_map;
        width_ = wild_ && draw_.one_in(3) ? draw_.of_size(-6, 3) : draw_.between(0.005, 0.05);
        table("surface");
        word("kind", kNames[static_cast<std::size_t>(kind_)]);
        if (kind_ == Kind::height_map)
            return map(image);
        circle(width_);
        if (kind_ != Kind::bump)
            return;
        text_ += fmt::format("facets = {}\n", facets());
        word("facet_spacing", draw_.any(kSpacings));
    }

    void force() {
        static constexpr std::array<const char*, 2> kDepths{"vertical", "normal"}, kReferences{"normal", "radial"};
        table("force");
        stiffness(wild_ ? draw_.of_size(-9, 12) : draw_.of_size(1, 4));
        const bool shaded = kind_ != Kind::cylinder_bump && !draw_.one_in(4);
        if (shaded)
            word("shading", kind_ == Kind::bump ? "reference" : "height_map");
        if (kind_ != Kind::bump)
            return;
        word("depth", draw_.any(kDepths));
        if (shaded)
            word("reference", draw_.any(kReferences));
    }

    void texture(Image& image) {
        table("texture");
        stiffness(wild_ ? draw_.of_size(-9, 12) : draw_.of_size(0, 3));
        map(image);
    }

    // Half of the grids have samples exactly on x = 0, z = 0, the edges and, of evenly spaced facets, on boundaries.
    void grid() {
        const bool aligned = draw_.one_in(2);
        const double step =
            aligned ? width_ / static_cast<double>(8u << draw_.below(4)) : width_ / draw_.between(wild_ ? 8 : 40, 70);
        const double ground = aligned ? 16 : draw_.between(10, 30);
        const std::array<double, 3> middle{32, 8, ground}; // the sample at 0
        const std::uint64_t place = draw_.below(8);
        std::array<double, 3> origin{}, spacing{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            spacing[axis] = aligned ? step : step * draw_.between(0.3, 1);
            if (wild_ && place == 0)
                spacing[axis] = 1e-9;
            origin[axis] = -middle[axis] * spacing[axis];
            if (wild_ && place == 0 && axis == 0)
                origin[axis] += width_ / 2 * (draw_.one_in(2) ? 1 : draw_.between(-1, 1)); // at the edge, or on a facet
            if (wild_ && place == 1)
                origin[axis] += draw_.one_in(2) ? 1000 : -1000;
            if (place >= 6 && axis < 2)
                origin[axis] += spacing[axis] * draw_.between(-20, 20);
        }
        table("grid");
        text_ += "size = [64, 16, 32]\n";
        lengths("origin", origin);
        lengths("spacing", spacing);
    }

    // Each set is a kernel of its own to compile, so there are few.
    void channels() {
        static constexpr std::array<const char*, 3> kSets{"\"force\"", "\"depth\", \"unshaded\"",
                                                          "\"force\", \"depth\", \"facet\", \"proxy\", \"unshaded\""};
        table("output");
        text_ += fmt::format("channels = [{}]\n", draw_.any(kSets));
    }

    Draw draw_;
    bool wild_;
    std::string text_;
    Kind kind_ = Kind::bump;
    double width_ = 0; /* m */
};

} // namespace

PreparedCase random_scene(std::uint64_t seed, Conditioning conditioning) {
    return Maker(seed, conditioning == Conditioning::anything).make();
}

} // namespace forceshade::test
