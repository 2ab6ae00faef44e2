// Validation of hardware, by engines that pretend to be some: right ones must pass, and wrong ones fail, channel by
// channel.
#include <cmath>
#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "host/output/height_image.h"
#include "host/referee/validate.h"
#include "tests/unit/laws.h"

namespace forceshade::test {
namespace {

using Contact = reference::Contact<double>;

PreparedCase prepared(const std::string& text) {
    PreparedCase prepared;
    prepared.scene = text + "\n[output]\nchannels = [\"force\", \"depth\", \"facet\", \"proxy\", \"unshaded\"]\n";
    prepared.one = parse_scene(prepared.scene, "judged scene");
    return prepared;
}

// Samples on z = 0, on vertices, on the bump's edge and on the cylinder's axis.
const std::string kGrid =
    "[grid]\nsize = [41, 2, 25]\norigin = [\"-20 mm\", \"0.3 mm\", \"-16 mm\"]\nspacing = \"1 mm\"\n";
const std::string kFacets = "[surface]\nkind = \"bump\"\nwidth = \"32 mm\"\nradius = \"20 mm\"\nfacets = 8\n"
                            "facet_spacing = \"equal_x\"\n";
const std::string kCylinder = "[surface]\nkind = \"cylinder_bump\"\nwidth = \"32 mm\"\nradius = \"";
const std::string kTexture = "[texture]\nfunction = \"sine\"\nwidth = \"3 mm\"\nheight = \"0.5 mm\"\nstiffness = \"200 "
                             "N/m\"\n";

std::vector<PreparedCase> cases() {
    std::vector<PreparedCase> all;
    for (const char* force :
         {"", "shading = \"reference\"\n", "shading = \"reference\"\nreference = \"radial\"\n", "depth = \"normal\"\n"})
        all.push_back(prepared(kFacets + "[force]\n" + force + kTexture + kGrid));
    for (const char* radius : {"16 mm\"\n", "20 mm\"\n", "2 m\"\n"})
        all.push_back(prepared(kCylinder + radius + kTexture + kGrid));
    for (const char* map : {"gaussian\"\nradius = \"7 mm\"\n", "sine\"\nwidth = \"3 mm\"\n"})
        all.push_back(prepared("[surface]\nkind = \"height_map\"\nheight = \"1 mm\"\nfunction = \"" + std::string(map) +
                               "[force]\nshading = \"height_map\"\n" + kGrid));
    return all;
}

// Depths of a few denormal steps, as height map and as flat bump.
std::vector<PreparedCase> denormal_cases() {
    const std::string grid = "[grid]\nsize = [8, 1, 8]\norigin = [\"-12 mm\", \"0 m\", \"-4e-43 m\"]\n"
                             "spacing = [\"4 mm\", \"1 mm\", \"1e-43 m\"]\n";
    return {prepared("[surface]\nkind = \"height_map\"\nfunction = \"sine\"\nwidth = \"3 mm\"\nheight = \"1 mm\"\n"
                     "[force]\nshading = \"height_map\"\nstiffness = \"1 N/m\"\n" +
                     grid),
            prepared("[surface]\nkind = \"bump\"\nfacets = 1\n[force]\nstiffness = \"1 N/m\"\n" + kTexture + grid)};
}

// Hardware whose every result is `say` of the law in double at the probe, rounded to the precision.
class Pretender : public Engine {
public:
    using Say = std::function<Contact(const Contact&)>;
    Pretender(const PreparedCase& prepared, Say say)
        : tables_(make_tables<double>(prepared.one.scene, prepared.images, Extent::everything)), say_(std::move(say)) {}

    EngineReport report() const override {
        EngineReport report;
        report.engine = "gpu";
        report.software = false;
        return report;
    }
    EngineTimes run(const EngineWork& work) override {
        std::visit(
            [&](const auto& one) {
                if constexpr (!requires { one.take_metrics; })
                    pretend(one);
            },
            work);
        return {};
    }

private:
    template <typename T> void pretend(const FieldWork<T>& work) const {
        const layout::FieldInput<T>& input = work.input;
        std::vector<T> force, depth, proxy, unshaded;
        std::vector<layout::uint> facet;
        const auto append = [](std::vector<T>& to, const reference::Vector<double>& value) {
            for (int i = 0; i < 3; ++i)
                to.push_back(static_cast<T>(value[i]));
        };
        for (const T z : input.z)
            for (const T y : input.y)
                for (const T x : input.x) {
                    const Contact said = say_(reference::evaluate(tables_.law(), {double(x), double(y), double(z)}));
                    append(force, said.force);
                    append(proxy, said.proxy);
                    append(unshaded, said.unshaded);
                    depth.push_back(static_cast<T>(said.depth));
                    facet.push_back(said.facet);
                }
        work.take({input.x.size(), input.x.size(), 0, input.y.size(), 0, input.z.size(), force, depth, facet, proxy,
                   unshaded});
    }

    FieldTables<double> tables_;
    Say say_;
};

Comparison judged(const PreparedCase& one, const Pretender::Say& say, Precision precision = Precision::f32) {
    Pretender engine(one, say);
    return compare_case(engine, one, precision);
}

// Forces less exact than single precision by a few ULP, as Vulkan's divisions and roots allow. A free proxy and the
// depth below a plane take none.
Contact coarse(const Contact& exact) {
    Contact result = exact;
    result.force *= 1 - 4 * 0x1p-23;
    result.unshaded *= 1 + 4 * 0x1p-23;
    return result;
}

// Takes every number that is not normal in single precision for zero.
Contact flushed(const Contact& exact) {
    const auto flush = [](double value) { return std::abs(value) < 0x1p-126 ? 0 : value; };
    const auto each = [&](reference::Vector<double> value) {
        return reference::Vector<double>{flush(value.x), flush(value.y), flush(value.z)};
    };
    Contact result{flush(exact.depth), each(exact.force), each(exact.unshaded), each(exact.proxy), exact.facet};
    if (result.depth == 0)
        result.facet = layout::kNoFacet;
    return result;
}

TEST(Judge, AcceptsHardwareThatIsRight) {
    std::vector<PreparedCase> all = cases();
    // So flat that no single precision tells it from the plane.
    all.push_back(prepared(kCylinder + "2000 km\"\n" + kTexture + kGrid));
    for (const PreparedCase& one : all)
        for (const auto& say : {Pretender::Say([](const Contact& exact) { return exact; }), Pretender::Say(coarse)}) {
            const Comparison comparison = judged(one, say);
            EXPECT_TRUE(comparison.passed) << comparison.first_difference << "\n" << one.scene;
            EXPECT_GT(comparison.differing, 0u);
        }
}

TEST(Judge, AcceptsHardwareThatTakesDenormalNumbersForZero) {
    for (const PreparedCase& one : denormal_cases()) {
        const Comparison comparison = judged(one, flushed);
        EXPECT_TRUE(comparison.passed) << comparison.first_difference << "\n" << one.scene;
        EXPECT_GT(comparison.differing, 0u);
    }
}

// No bits differ: the referee's denormal depths have digits that the law's do not.
TEST(Judge, AcceptsTheOracleAtDenormalDepths) {
    EngineOptions options;
    options.cpu = true;
    const auto engine = make_engine(options);
    for (const PreparedCase& one : denormal_cases())
        for (const Precision precision : {Precision::f32, Precision::f64}) {
            const Comparison comparison = compare_case(*engine, one, precision);
            EXPECT_EQ(comparison.differing, 0u);
            EXPECT_EQ(comparison.oracle.boundary + comparison.closed_form.boundary, 0u);
            EXPECT_TRUE(comparison.passed) << comparison.first_difference << "\n" << one.scene;
        }
}

struct Lie {
    const char* name;
    void (*tell)(Contact&);
};

TEST(Judge, RefusesEveryChannelThatIsWrong) {
    const Lie lies[] = {
        {"force", [](Contact& contact) { contact.force.z *= 1.001; }},
        {"depth", [](Contact& contact) { contact.depth *= 1.001; }},
        {"depth", [](Contact& contact) { contact.depth = std::numeric_limits<double>::quiet_NaN(); }},
        {"facet", [](Contact& contact) { contact.facet += contact.facet == 0 ? 1u : -1u; }},
        {"facet", [](Contact& contact) { contact.facet = layout::kNoFacet; }},
        {"proxy", [](Contact& contact) { contact.proxy.z += 1e-5; }},
        {"proxy", [](Contact& contact) { contact.proxy.y = 0; }},
        {"unshaded", [](Contact& contact) { contact.unshaded *= 1.001; }},
        {"unshaded", [](Contact& contact) { contact.unshaded.x = std::numeric_limits<double>::quiet_NaN(); }},
    };
    for (const PreparedCase& one : cases())
        for (const Lie& lie : lies)
            for (const Precision precision : {Precision::f32, Precision::f64}) {
                const auto say = [&](const Contact& exact) {
                    Contact told = exact;
                    const bool on_edge = std::abs(std::abs(exact.proxy.x) - 0.016) < 1e-4;
                    if (exact.depth > 0.0158 && !on_edge)
                        lie.tell(told);
                    return told;
                };
                const Comparison comparison = judged(one, say, precision);
                EXPECT_FALSE(comparison.passed) << lie.name << "\n" << one.scene;
                EXPECT_NE(comparison.first_difference.find(lie.name), std::string::npos) << comparison.first_difference;
                EXPECT_GT(comparison.beyond, 0u) << lie.name;
                EXPECT_GT(comparison.oracle.unexplained, 0u) << lie.name;
                EXPECT_GT(comparison.closed_form.unexplained, 0u) << lie.name;
            }
}

// However ill conditioned its direction is, a force has its length.
TEST(Judge, RefusesNoForceOnASteepMap) {
    PreparedCase one = prepared("[surface]\nkind = \"height_map\"\nfile = \"step.png\"\nsize = [\"20 mm\", \"10 "
                                "mm\"]\n[force]\nshading = \"height_map\"\n" +
                                kGrid);
    const auto image = std::make_shared<HeightImage>();
    image->columns = 20;
    image->rows = 2;
    for (int i = 0; i < 40; ++i)
        image->samples.push_back(i % 20 < 10 ? 0 : 1e10);
    one.images.map = image;
    EXPECT_TRUE(judged(one, [](const Contact& exact) { return exact; }).passed);
    const Comparison comparison = judged(one, [](Contact exact) {
        exact.force = {0, 0, 0};
        return exact;
    });
    const std::uint64_t in_contact = 41 * 2 * 16;
    EXPECT_EQ(comparison.oracle.unexplained, in_contact);
    EXPECT_EQ(comparison.closed_form.unexplained, in_contact);
}

} // namespace
} // namespace forceshade::test
