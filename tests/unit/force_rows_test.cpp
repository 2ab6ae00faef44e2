// Rows of forces, several samples at a time, hold the bits of the law at each sample.
#include "host/reference/field.h"

#include <cstring>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "host/field/prepared_case.h"
#include "host/reference/contact.h"
#include "host/scene/study.h"

namespace forceshade {
namespace {

// Every analytic law: surface and force, then a texture.
std::vector<std::string> laws() {
    std::vector<std::string> surfaces;
    const std::string bump = "[surface]\nkind = \"bump\"\nradius = \"600 mil\"\nfacets = 3\n[force]\n";
    for (const char* depth : {"vertical", "normal"})
        for (const char* shading : {"\"none\"", "\"reference\"", "\"reference\"\nreference = \"radial\""})
            surfaces.push_back(bump + fmt::format("depth = \"{}\"\nshading = {}\n", depth, shading));
    surfaces.push_back("[surface]\nkind = \"cylinder_bump\"\nradius = \"600 mil\"\n");
    for (const char* map : {"cylinder\"\nradius = \"600 mil", "dip\"\nradius = \"600 mil", "sine\"\nheight = \"1 mm",
                            "gaussian\"\nradius = \"5 mm"})
        surfaces.push_back(fmt::format(
            "[surface]\nkind = \"height_map\"\nfunction = \"{}\"\n[force]\nshading = \"height_map\"\n", map));
    std::vector<std::string> all;
    for (const std::string& surface : surfaces)
        for (const char* texture :
             {"", "[texture]\nstiffness = \"1 kN/mm\"\nfunction = \"sine\"\nwidth = \"2 mm\"\n",
              "[texture]\nfunction = \"gaussian\"\nradius = \"5 mm\"\n", "[texture]\nfunction = \"dip\"\n"})
            all.push_back(surface + texture);
    return all;
}

// On the axis, at the edges, so far away that squares and the texture overflow, and as many samples as no vector has.
template <typename T> std::vector<T> coordinates(double half_width, double axis) {
    std::vector<T> values;
    for (const double value : {0.0, half_width, axis, 1e-30, 1e15, 1e33})
        for (const double sign : {-1.0, 1.0}) {
            values.push_back(static_cast<T>(sign * value));
            values.push_back(std::nextafter(values.back(), T(0)));
        }
    for (int i = -20; i <= 20; ++i)
        values.push_back(static_cast<T>(0.00073 * i));
    return values;
}

template <typename T> void expect_bits_of_the_law(const FieldTables<T>& tables, unsigned threads) {
    const layout::FieldInput<T> input = tables.input();
    ASSERT_TRUE(reference::ForceRows<T>::serve(input.law.features));
    std::size_t differing = 0, in_contact = 0, samples = 0;
    reference::FieldOptions options;
    options.threads = threads;
    options.chunk_bytes = 100000;
    reference::evaluate_field<T>(input, options, [&](const layout::FieldChunk<T>& chunk) {
        for (std::size_t z = 0; z < chunk.z_count; ++z)
            for (std::size_t y = 0; y < chunk.y_count; ++y)
                for (std::size_t x = 0; x < chunk.x_count; ++x, ++samples) {
                    const auto contact = reference::evaluate<T>(
                        input.law, {tables.x[x], tables.y[chunk.y_first + y], tables.z[chunk.z_first + z]});
                    const T force[3] = {contact.force.x, contact.force.y, contact.force.z};
                    const T* const row = &chunk.force[3 * ((z * chunk.y_count + y) * chunk.x_pitch + x)];
                    in_contact += contact.facet != layout::kNoFacet;
                    for (int c = 0; c < 3; ++c) // which bits are no number is the processor's choice
                        differing += std::memcmp(&row[c], &force[c], sizeof(T)) != 0 &&
                                     !(std::isnan(row[c]) && std::isnan(force[c]));
                }
    });
    EXPECT_EQ(samples, tables.x.size() * tables.y.size() * tables.z.size());
    EXPECT_GT(in_contact, samples / 10);
    EXPECT_LT(in_contact, samples);
    EXPECT_EQ(differing, 0u);
}

template <typename T> void expect_bits_of_the_law(const std::string& text) {
    SCOPED_TRACE(text);
    const Scene scene = parse_scene(text, "test").scene;
    FieldTables<T> tables = make_tables<T>(scene, {}, Extent::everything);
    tables.x = tables.z = coordinates<T>(scene.surface.width / 2, tables.params.centre_depth);
    tables.y = coordinates<T>(0.003, 0.001);
    for (const unsigned threads : {1u, 3u})
        expect_bits_of_the_law(tables, threads);
}

TEST(ForceRows, HoldTheBitsOfTheLaw) {
    for (const std::string& text : laws()) {
        expect_bits_of_the_law<float>(text);
        expect_bits_of_the_law<double>(text);
    }
}

// More columns than are kept are made anew, chunk by chunk.
TEST(ForceRows, HoldTheBitsOfAWideGrid) {
    const Scene scene =
        parse_scene("[surface]\nkind = \"height_map\"\nfunction = \"gaussian\"\nradius = \"5 mm\"\n"
                    "[force]\nshading = \"height_map\"\n[grid]\nsize = [1201, 1300, 3]\n"
                    "origin = [\"-8 mm\", \"-8 mm\", \"-1 mm\"]\nspacing = [\"13 um\", \"13 um\", \"0.5 mm\"]\n",
                    "test")
            .scene;
    expect_bits_of_the_law(make_tables<float>(scene, {}, Extent::everything), 2);
}

TEST(ForceRows, ServeForcesAlone) {
    layout::Features features;
    EXPECT_TRUE(reference::ForceRows<float>::serve(features));
    features.channels |= layout::kChannelDepth;
    EXPECT_FALSE(reference::ForceRows<float>::serve(features));
    features.channels = layout::kChannelForce;
    features.surface = layout::kSurfaceMesh;
    EXPECT_FALSE(reference::ForceRows<float>::serve(features));
}

} // namespace
} // namespace forceshade
