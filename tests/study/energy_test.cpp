// Work round loops below a surface, against closed forms; curl; and what is said of loops.
#include <algorithm>
#include <cmath>
#include <span>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "host/error.h"
#include "host/mesh/mesh.h"
#include "host/output/files.h"
#include "host/reference/elementary.h"
#include "host/study/energy/energy.h"
#include "host/touch/own_surfaces.h"
#include "host/touch/places.h"
#include "tests/io/folder.h"
#include "tests/places.h"

namespace forceshade::study {
namespace {

using testing::says;

// Work round a loop over half a bump in closed form: out below the nominal surface from x = 0 to x1 at depth d1, back
// at depth d2.
struct BumpLoop {
    double stiffness; /* K, N/m */
    double radius;    /* R, m */
    double end;       /* x1, m: less than a */
    double out, back; /* d1, d2, m: vertical depths */
};

double squares(const BumpLoop& loop) {
    return 0.5 * loop.stiffness * (loop.out * loop.out - loop.back * loop.back);
}

/// The chord of the circle over [left, right].
double chord_slope(double radius, double left, double right) {
    return -(left + right) / (reference::circle_rise(radius, left) + reference::circle_rise(radius, right));
}

double cosine(double slope) {
    return 1 / std::sqrt(1 + slope * slope);
}

/// The integral of N_z = sqrt(R^2 - x^2) / R from 0 to x, m.
double upward(double radius, double x) {
    return (x * reference::circle_rise(radius, x) + radius * radius * std::asin(x / radius)) / (2 * radius);
}

/// use(from, to, slope) for each facet's part within [0, x1], from left to right.
template <typename Use> void over_facets(const BumpLoop& loop, std::span<const double> vertices, const Use& use) {
    for (std::size_t i = 0; i + 1 < vertices.size(); ++i) {
        const double from = std::max(vertices[i], 0.0), to = std::min(vertices[i + 1], loop.end);
        if (from < to)
            use(from, to, chord_slope(loop.radius, vertices[i], vertices[i + 1]));
    }
}

/// The flat shaded plane (L4 with one facet, L5 of a cylinder): K (d1 - d2) x1^2 / (2 R) + K/2 (d1^2 - d2^2) (N_z(x1) -
/// 1), J.
double shaded_plane_work(const BumpLoop& loop) {
    return loop.stiffness * (loop.out - loop.back) * loop.end * loop.end / (2 * loop.radius) +
           squares(loop) * (reference::circle_rise(loop.radius, loop.end) / loop.radius - 1);
}

/// The plane with `two_pass` shading of the cylinder's normals: K (d1 - d2) (U(0) - U(x1)), J.
double two_pass_plane_work(const BumpLoop& loop) {
    return loop.stiffness * (loop.out - loop.back) * (loop.radius - reference::circle_rise(loop.radius, loop.end));
}

/// n facets with ascending vertices (m), unshaded: every break gives K/2 (c_R - c_L) (d1^2 - d2^2), c the cosine of the
/// slope, or its square where depth is read along the normal, J. Vertices outside [0, x1] count for nothing.
double faceted_work(const BumpLoop& loop, std::span<const double> vertices, bool normal_depth) {
    double sum = 0, before = 0;
    bool first = true;
    over_facets(loop, vertices, [&](double, double, double slope) {
        const double c = normal_depth ? 1 / (1 + slope * slope) : cosine(slope);
        sum += first ? 0 : c - before;
        before = c;
        first = false;
    });
    return squares(loop) * sum;
}

/// The same facets, shaded by the cylinder's normal above the probe, J: on a facet of slope s with c as above (1 for
/// vertical depth) the integral of K (d1 - d2) c (N_x + s N_z) dx, and K/2 (d1^2 - d2^2) c N_z at both ends.
double shaded_facets_work(const BumpLoop& loop, std::span<const double> vertices, bool normal_depth) {
    const double radius = loop.radius;
    double along = 0, first = 0, last = 0;
    bool begun = false;
    over_facets(loop, vertices, [&](double from, double to, double slope) {
        const double c = normal_depth ? cosine(slope) : 1;
        along += c * ((to - from) * (to + from) / (2 * radius) + slope * (upward(radius, to) - upward(radius, from)));
        first = begun ? first : c;
        begun = true;
        last = c;
    });
    return loop.stiffness * (loop.out - loop.back) * along +
           squares(loop) * (last * reference::circle_rise(radius, loop.end) / radius - first);
}

constexpr double kEnd = 0.999 * 0.0127; // m: x1 of the laws' loop

EnergyLaw bump_law(const char* radius, int facets, const char* shading, const char* depth = "vertical") {
    auto prepared = std::make_shared<PreparedCase>(CasePreparation().prepare(
        parse_scene(fmt::format("surface = {{radius = \"{}\", facets = {}}}\nforce = {{stiffness = \"500 N/m\", "
                                "shading = \"{}\", depth = \"{}\"}}",
                                radius, facets, shading, depth),
                    "test")));
    return {"bump", shading, double(facets), std::string(shading) == "none", prepared};
}

LoopWork work_of(const EnergyLaw& law, const Stroke& stroke, std::size_t steps = 512) {
    return work_by_place(law, places_of_loop(law, stroke, steps).value()).value();
}

const Stroke kLawsLoop{{0, 0}, {kEnd, 0}, 0.002, 0.001};

TEST(EnergyLoops, GiveWhatTheLawsSayOnTheShadedPlane) {
    const std::pair<const char*, double> kTable[] = {
        {"600 mil", 2.3061e-3}, {"1000 mil", 1.4841e-3}, {"1400 mil", 1.0823e-3}};
    for (const auto& [radius, joules] : kTable) {
        const LoopWork shaded = work_of(bump_law(radius, 1, "reference"), kLawsLoop);
        EXPECT_NEAR(shaded.work, joules, 1e-7) << radius;
        EXPECT_NEAR(work_of(bump_law(radius, 1, "none"), kLawsLoop).work, 0, 1e-15);
        EXPECT_GT(shaded.effort, shaded.work);
    }
    const double radius = 0.01524;
    EXPECT_NEAR(shaded_plane_work({500, radius, kEnd, 0.002, 0.001}), 2.3061e-3, 5e-8);
    EXPECT_NEAR(two_pass_plane_work({500, radius, kEnd, 0.002, 0.001}), 3.398e-3, 5e-7);
}

// Breaks between facets give energy, too. Places are joined by straight lines, which cut a break's corner a little.
TEST(EnergyLoops, GiveTheClosedFormOverFacets) {
    for (const int facets : {2, 3, 5, 32}) {
        std::vector<double> vertices; // equal arcs
        const double radius = 0.01524, half = std::asin(0.0127 / radius);
        for (int i = 0; i <= facets; ++i)
            vertices.push_back(radius * std::sin(half * (2.0 * i / facets - 1)));
        const BumpLoop loop{500, radius, kEnd, 0.002, 0.001};
        for (const bool normal : {false, true}) {
            const char* const depth = normal ? "normal" : "vertical";
            EXPECT_NEAR(work_of(bump_law("600 mil", facets, "none", depth), kLawsLoop, 8192).work,
                        faceted_work(loop, vertices, normal), 1e-7);
            EXPECT_NEAR(work_of(bump_law("600 mil", facets, "reference", depth), kLawsLoop, 8192).work,
                        shaded_facets_work(loop, vertices, normal), 2e-7);
        }
    }
}

EnergyLaw mesh_law(const std::shared_ptr<const SceneMesh>& mesh, Shading shading) {
    auto prepared = std::make_shared<PreparedCase>();
    prepared->one.scene.surface.kind = SurfaceKind::mesh;
    prepared->one.scene.force.stiffness = 500;
    prepared->one.scene.force.shading = shading;
    prepared->images.mesh = mesh;
    return {"mesh", "", 8, shading == Shading::none, prepared};
}

// The bump's block with a flat top at z = 0, whose vertices have the circle's normals (those at |x| = a beyond it): the
// flat plane, force shaded by interpolation.
std::shared_ptr<const SceneMesh> shaded_plane_mesh(const BumpMesh& bump) {
    PolygonSoup block = bump_mesh(bump)->mesh.polygons;
    for (glm::dvec3& vertex : block.vertices)
        vertex.z = vertex.z < -bump.half_width ? vertex.z : 0; // but for its floor
    auto mesh = std::make_shared<SceneMesh>();
    mesh->findings = inspect(block);
    mesh->mesh = prepare_mesh(std::move(block), MeshPlacement{}, VertexNormals::plain);
    for (std::size_t i = 0; i < mesh->mesh.polygons.vertices.size(); ++i) {
        const double x = std::clamp(mesh->mesh.polygons.vertices[i].x, -bump.half_width, bump.half_width) / bump.radius;
        mesh->mesh.vertex_normals[i] = {x, 0, std::sqrt(1 - x * x)};
    }
    mesh->structure = build_structure(mesh->mesh);
    if (is_solid(mesh->findings))
        assume_solid(mesh->structure);
    return mesh;
}

TEST(EnergyLoops, OfTheShadedPlaneAsAMeshComeToTheLawsFigures) {
    const auto plane = shaded_plane_mesh({0.0127, 0.03556, 128, 4}); // R = 1400 mil
    const BumpLoop loop{500, 0.03556, kEnd, 0.002, 0.001};
    EXPECT_NEAR(work_of(mesh_law(plane, Shading::mean_value), kLawsLoop).work, shaded_plane_work(loop), 1e-6);
    EXPECT_NEAR(work_of(mesh_law(plane, Shading::two_pass), kLawsLoop).work, two_pass_plane_work(loop), 1e-6);
}

TEST(EnergyLoops, TellAConservativeFieldFromOneThatIsNot) {
    const auto mesh = bump_mesh({0.0127, 0.0254, 4, 4});
    const Stroke stroke{{-0.01, 0.002}, {0.009, -0.004}, 0.002, 0.0005};
    EXPECT_NEAR(work_of(mesh_law(mesh, Shading::none), stroke).work, 0, 1e-10);
    EXPECT_GT(std::abs(work_of(mesh_law(mesh, Shading::morgenbesser), stroke).work), 1e-6);
    const EnergyLaw law = mesh_law(mesh, Shading::none);
    auto places = places_of_loop(law, stroke, 1024).value();
    EXPECT_LT(work_by_history(law, places).value().work, -1e-6) << "the proxy lags behind whichever way it goes";
    std::ranges::reverse(places);
    EXPECT_LT(work_by_history(law, places).value().work, -1e-6);
}

TEST(EnergyLoops, ThatLeaveTheSurfaceCountForNothing) {
    const EnergyLaw law = mesh_law(bump_mesh({0.0127, 0.0254, 4, 4}), Shading::none);
    EXPECT_FALSE(places_of_loop(law, {{0, 0}, {0.05, 0}, 0.002, 0.001}, 64));
    const EnergyLaw bump = bump_law("600 mil", 2, "none");
    EXPECT_FALSE(work_by_place(bump, places_of_loop(bump, {{0, 0}, {0.01, 0}, 0.002, -0.001}, 64).value()));
}

TEST(EnergyLoops, AsPathsComeDownAndGoRoundTwice) {
    for (const EnergyLaw& law :
         {mesh_law(bump_mesh({0.0127, 0.0254, 4, 4}), Shading::none), bump_law("600 mil", 2, "none")}) {
        const auto places = places_of_loop(law, {{0.002, 0}, {0.005, 0}, 0.002, 0.001}, 64).value();
        const auto path = path_of_loop(law, places);
        const std::size_t round = places.size() - 1;
        EXPECT_EQ(CaseProbe<double>(*law.prepared).at(path.front()).contact.facet, layout::kNoFacet) << "above";
        EXPECT_EQ(path.back(), places.front());
        EXPECT_EQ(path[path.size() - 1 - round], places.front());
        std::vector<glm::dvec3> turning; // curl_y F = 2 N/m: twice the area
        for (const glm::dvec3& at : path)
            turning.emplace_back(at.z, 0, -at.x);
        EXPECT_NEAR(std::abs(work_of_last(path, turning, round).work), 2 * 0.003 * 0.001, 1e-12);
    }
}

// Of strokes over the study's own meshes of 8 cells, each in turn tessellated anew; `first`: the first of ten seeds.
Interval gain_over_patches(std::uint64_t first, bool drawn = true) {
    constexpr double kHalf = 0.0127, kRadius = 0.01524; // m
    std::vector<double> gains;
    const std::vector<Stroke> strokes = drawn_strokes({{-kHalf, -0.01}, {kHalf, 0.01}}, 100);
    for (std::size_t i = 0; i < strokes.size(); ++i) {
        const BumpMesh cells{kHalf, kRadius, 8, 8};
        const EnergyLaw law =
            mesh_law(drawn ? cylinder_patch(cells, DrawnPatch{0.0191, first + i % 10}) : bump_mesh(cells),
                     Shading::morgenbesser);
        gains.push_back(std::abs(work_of(law, strokes[i], 128).work));
    }
    return bootstrap_median(gains);
}

TEST(EnergyLoops, OnMeshesHaveTheGainsOfOtherTessellations) {
    const Interval one = gain_over_patches(1), other = gain_over_patches(101), aligned = gain_over_patches(1, false);
    EXPECT_LT(one.low, other.median);
    EXPECT_GT(one.high, other.median);
    EXPECT_GT(aligned.median, std::max(one.high, other.high)) << "an accident of alignment";
}

TEST(EnergyStrokes, AreDrawnAnywhereInTheRegion) {
    const StrokeRegion region{{-0.01, -0.002}, {0.03, 0.002}, 1e-3};
    const std::vector<Stroke> strokes = drawn_strokes(region, 500);
    double far = 0;
    for (const Stroke& stroke : strokes) {
        EXPECT_GE(std::hypot(stroke.to.x - stroke.from.x, stroke.to.y - stroke.from.y), 0.01);
        EXPECT_GE(std::min(stroke.out, stroke.back), 0.99e-4);
        EXPECT_LE(std::max(stroke.out, stroke.back), 1e-3);
        far += stroke.from.x > 0.01;
    }
    EXPECT_NEAR(far / 500, 0.5, 0.1);
    EXPECT_EQ(drawn_strokes(region, 3)[2].to, strokes[2].to);
}

TEST(EnergyResults, CompareTheSameLoops) {
    EnergyResults results;
    results.surfaces = {{"scene", "", {}, {}, {bump_law("600 mil", 2, "none"), bump_law("600 mil", 2, "reference")}}};
    auto& laws = results.surfaces[0].laws;
    laws[0].scheme = "unshaded";
    for (std::size_t i = 0; i < 9; ++i) {
        results.loops.push_back({&laws[0], false, i, 1e-3 * double(i), 2e-3});
        results.loops.push_back({&laws[1], false, i, 1e-3 * double(i) + 5e-3, 4e-3});
    }
    results.laws = summarise_by_law(results.loops);
    ASSERT_EQ(results.laws.size(), 2u);
    EXPECT_NEAR(results.laws[0].gain.median, 4e-3, 1e-12);
    EXPECT_FALSE(results.laws[0].more);
    EXPECT_NEAR(results.laws[1].more->low, 5e-3, 1e-12) << "each loop is compared with itself";
    EXPECT_NEAR(results.laws[1].more->high, 5e-3, 1e-12);
    StudyData data;
    data.scene = "a scene";
    add_energy(data, results);
    ASSERT_EQ(data.findings.size(), 1u);
    EXPECT_TRUE(says(data.findings[0].text, "scene's surface", "reference 9 mJ"));
    EXPECT_EQ(data.table("closed_strokes").rows.size(), 18u);
}

TEST(EnergyCurl, OfALinearFieldIsExactAndUnknownWhereACornerIsFree) {
    SectionField field;
    for (int i = 0; i < 4; ++i) {
        field.x.push_back(i);
        field.z.push_back(2 * i);
    }
    for (const double z : field.z)
        for (const double x : field.x) {
            field.force.insert(field.force.end(), {3 * z, 0, -x});
            field.depth.push_back(x == 3 ? 0 : 1);
        }
    const std::vector<double> curl = cell_curls(field);
    ASSERT_EQ(curl.size(), 9u);
    EXPECT_EQ(curl[0], 4);
    EXPECT_EQ(curl[7], 4);
    EXPECT_TRUE(std::isnan(curl[2])) << "a corner is free";
}

// The laws: -K N_x + K z dN_z/dx on the flat shaded plane.
TEST(EnergyCurl, OfTheShadedPlaneIsItsClosedForm) {
    const testing::Folder folder;
    EngineOptions options;
    options.cpu = true;
    const auto engine = make_engine(options);
    std::vector<FileRecord> volumes;
    const double radius = 0.0254;
    std::size_t inside = 0;
    for (const CurlCell& cell : curl_map(*engine, bump_law("1000 mil", 1, "reference"),
                                         {{-0.0127, -0.005}, {0.0127, 0.005}}, 24, folder.path(), volumes)) {
        if (std::abs(cell.x) > 0.011)
            continue;
        ++inside;
        const double sine = cell.x / radius;
        EXPECT_NEAR(cell.curl_per_stiffness, -sine - cell.z * sine / (radius * std::sqrt(1 - sine * sine)), 4e-3);
    }
    EXPECT_GT(inside, 20u);
    ASSERT_EQ(volumes.size(), 1u);
    for (const FileRecord& volume : volumes)
        EXPECT_TRUE(file_is_intact(folder / volume.name, volume.sha256));
}

TEST(EnergyScene, HasEachSchemeOfItsSurfaceAndNeedsRoom) {
    const auto laws_of = [](const std::string& text) {
        return scene_energy_surface(CasePreparation().prepare(parse_scene(text, "scene.toml"))).laws.size();
    };
    EXPECT_EQ(laws_of("surface = {facets = 4}"), 2u);
    EXPECT_EQ(laws_of("surface.kind = \"cylinder_bump\""), 1u);
    EXPECT_EQ(laws_of("surface = {kind = \"height_map\", function = \"sine\"}"), 2u);
    EXPECT_EQ(laws_of("surface = {kind = \"mesh\", file = \"" + in_source("tests/data/spot.obj") + "\"}"), 4u);
}

} // namespace
} // namespace forceshade::study
