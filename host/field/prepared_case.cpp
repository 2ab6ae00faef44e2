#include "host/field/prepared_case.h"

#include <algorithm>
#include <cmath>
#include <future>
#include <limits>

#include <fmt/format.h>

#include "host/clock.h"
#include "host/error.h"
#include "host/field/mesh_cache.h"
#include "host/long_run.h"
#include "host/mesh/clearance.h"
#include "host/mesh/mesh.h"
#include "host/mesh/mesh_file.h"
#include "host/mesh/places.h"
#include "host/output/files.h"
#include "host/output/height_image.h"
#include "host/reference/elementary.h"
#include "host/reference/god_object.h"
#include "host/scene/scene.h"
#include "host/scene/schema.h"
#include "host/spelling.h"
#include "host/vibration/vibration.h"

namespace forceshade {

std::shared_ptr<SceneMesh> made_mesh(PolygonSoup polygons, bool winding, const MeshPlacement& placement) {
    auto mesh = std::make_shared<SceneMesh>();
    mesh->findings = inspect(polygons);
    mesh->mesh = prepare_mesh(std::move(polygons), placement, VertexNormals::plain);
    mesh->structure = build_structure(mesh->mesh, {.winding = winding});
    if (is_solid(mesh->findings))
        assume_solid(mesh->structure);
    return mesh;
}

void require_file(const FileSpec& spec) {
    std::error_code error;
    if (!spec.path.empty() && std::filesystem::status(spec.path, error).type() == std::filesystem::file_type::not_found)
        throw IoError("{}{}cannot read {}: No such file or directory{}", spec.place, spec.place.empty() ? "" : ": ",
                      spec.file, missing_file_advice(spec.path, spec.file));
}

void require_mesh_memory(const std::filesystem::path& file, std::size_t triangles) {
    constexpr double kTriangleBytes =
        1100; // measured: of the structure, its tables in both precisions and on the device
    require_memory(file, fmt::format("a mesh of {} triangles", triangles),
                   kTriangleBytes * static_cast<double>(triangles));
}

std::vector<std::string> warnings_of(const MeshSpec& spec, const SceneMesh& mesh, MeshUse use) {
    std::vector<std::string> result;
    std::vector<MeshFault> all = mesh.changes;
    std::ranges::move(faults(mesh.findings, use, "m", spec.unit * spec.scale), std::back_inserter(all));
    for (const MeshFault& fault : all)
        result.push_back(fmt::format("{}: {}", spec.file, sentence(fault)));
    if (use == MeshUse::winding_field && spec.inside == InsideTest::automatic)
        result.push_back(
            fmt::format("{}: inside = \"auto\" takes the winding number, since the mesh does not bound a solid without "
                        "crossings (inside = \"pseudonormal\" takes the nearest facet's side)",
                        spec.file));
    if (const std::size_t opposed = mesh.mesh.opposed_normals)
        result.push_back(fmt::format("{}: {} of {} corners have a normal in the file that points behind their facet, "
                                     "so that a shaded force there draws the probe in; turn faces or normals round",
                                     spec.file, opposed, mesh.mesh.polygons.corners.size()));
    constexpr double kFarthestReach = 10; // m
    const MeshBox box = bounding_box(mesh.mesh.polygons);
    const glm::dvec3 sides = box.high - box.low;
    if (const double longest = std::max({sides.x, sides.y, sides.z}); longest > kFarthestReach)
        result.push_back(fmt::format(
            "{}: is {:.3g} m across, which no hand spans; unit = \"{}\" if its numbers mean that, or transform.scale",
            spec.file, longest, unit_for_a_hand(longest / (spec.unit * spec.scale))));
    return result;
}

GridSpec fitted_grid(std::uint64_t samples, const Mesh& mesh) {
    constexpr double kMargin = 0.05; // of the box's longest side
    const MeshBox box = bounding_box(mesh.polygons);
    const glm::dvec3 sides = box.high - box.low; /* m */
    const double longest = std::max({0.0, sides.x, sides.y, sides.z});
    GridSpec grid;
    const double spacing = samples > 1 ? (1 + kMargin) * longest / static_cast<double>(samples - 1) : longest;
    for (int axis = 0; axis < 3; ++axis) {
        const auto i = static_cast<std::size_t>(axis);
        // A side as long as the longest one has as many samples, whatever the division rounds to.
        const double covered = sides[axis] + kMargin * longest;
        const double count = std::ceil(covered / spacing - 1e-9) + 1; // infinite where the spacing underflows
        grid.size[i] = count < static_cast<double>(samples) ? static_cast<std::uint64_t>(count) : samples;
        grid.spacing[i] = spacing;
        const double half = spacing * static_cast<double>(grid.size[i] - 1) / 2;
        grid.origin[i] = box.low[axis] + sides[axis] / 2 - half;
    }
    if (grid.size[1] * grid.size[2] > kMostRows)
        throw UsageError("grid.samples = {} makes {} rows, y times z; an EXR holds up to {}", samples,
                         grid.size[1] * grid.size[2], kMostRows);
    return grid;
}

namespace {

// In memory between cases: a sweep over files must not keep them all.
constexpr std::size_t kImages = 4;
constexpr std::size_t kMeshes = 2;
constexpr std::size_t kVibrations = 4;

// The file of a key, read unless it is in memory.
template <typename Key, typename File, typename Read>
std::shared_ptr<const File> cached(std::deque<std::pair<Key, std::shared_ptr<const File>>>& files, const Key& key,
                                   std::size_t most, const Read& read) {
    const auto known = std::find_if(files.begin(), files.end(), [&](const auto& one) { return one.first == key; });
    if (known != files.end()) {
        std::rotate(files.begin(), known, known + 1);
        return files.front().second;
    }
    files.emplace_front(key, read());
    if (files.size() > most)
        files.pop_back();
    return files.front().second;
}

// Pseudonormals where the mesh bounds solids without crossings, as far as that is known, and for sheets.
InsideTest inside_of(const MeshFindings& found, MeshStructure& structure) {
    if (!found.closed) {
        constexpr double kEnclosed = 0.9; // a shape with holes; behind sheets it is 1/2
        const auto winding = make_winding(structure);
        structure.winding = winding;
        if (winding_behind(structure) > kEnclosed)
            return InsideTest::winding;
        structure.winding = nullptr;
        return InsideTest::pseudonormal;
    }
    const bool sound = found.non_manifold_edges + found.misoriented_edges + found.opposed_facets +
                               found.inside_out.size() + found.nested.size() + found.one_sided.size() ==
                           0 &&
                       found.self_intersections.value_or(0) == 0;
    return sound ? InsideTest::pseudonormal : InsideTest::winding;
}

// Whether the tree shows that the file's triangles nowhere meet: it has them all, placed, and further apart than
// rounding has moved them. In doubt the file's own are looked at, which takes longer.
bool keeps_clear(const MeshSpec& spec, const MeshFindings& found, const MeshStructure& structure) {
    if (!structure.clearance || found.triangles != found.facets || found.redundant_facets > 0)
        return false;
    const glm::dvec3 moved(spec.translate[0], spec.translate[1], spec.translate[2]);
    const double reach =
        spec.unit * spec.scale *
            std::max(reference::largest_coordinate(found.low), reference::largest_coordinate(found.high)) +
        reference::largest_coordinate(moved); /* m */
    constexpr double kRoundings = 64 * std::numeric_limits<double>::epsilon();
    return kRoundings * reach < kLeastGap / 4 * structure.scale && structure.clearance->is_enough();
}

void refuse_missing_groups(const MeshSpec& spec, const PolygonSoup& polygons) {
    if (spec.normals == NormalWeights::groups && polygons.groups.empty())
        throw UsageError("{}: has no smoothing groups; normals = \"groups\" is for an OBJ file with s: \"crease:30 "
                         "deg\" finds sharp edges by their angle",
                         spec.file);
}

// Earlier findings, by the SHA-256 of their file and the changes made to it.
// \throws IoError, UsageError for a file in which the law has no meaning
std::shared_ptr<const SceneMesh> read_scene_mesh(const MeshSpec& spec, const PolygonFile* given,
                                                 std::map<std::string, MeshFindings>& findings) {
    if (!given)
        require_file(spec);
    PolygonFile file = given ? *given : read_polygons(spec.path, spec.normals == NormalWeights::file);
    refuse_missing_groups(spec, file.polygons);
    const std::size_t triangles =
        file.polygons.corners.size() - std::min(file.polygons.corners.size(), 2 * file.polygons.facets());
    require_mesh_memory(spec.path, triangles);
    auto mesh = std::make_shared<SceneMesh>();
    mesh->sha256 = file.sha256;
    mesh->format = file.format;
    mesh->file_triangles = triangles;
    for (const std::string& skipped : file.warnings)
        mesh->changes.push_back({skipped});
    if (!file.polygons.groups.empty() && spec.normals != NormalWeights::groups)
        mesh->changes.push_back({"has smoothing groups, which are not used",
                                 "normals = \"groups\" keeps the edges between them sharp", "",
                                 "normals = \"groups\""});
    const double weld = spec.weld / (spec.unit * spec.scale);
    const JoinedVertices joined = weld > 0 ? join_vertices(file.polygons, weld) : JoinedVertices{};
    if (joined.facets > 0 && joined.facets == file.polygons.facets())
        throw UsageError(
            "{}: weld = {} m joins the vertices of every facet, so that none is left; make it smaller than the edges",
            spec.file, spec.weld);
    if (spec.orient == Orientation::outward)
        for (const std::string& turned : orient_outward(file.polygons))
            mesh->changes.push_back({turned});
    std::optional<Connectivity> connected;
    // Looking at the file takes as long as preparing it.
    std::future<void> prepared = std::async(std::launch::async, [&] {
        const Stage stage("preparing the mesh");
        connected.emplace(file.polygons, Connectivity::Method::matched_edges); // half-edges take 20 times as long
        mesh->mesh = prepare_mesh(
            file.polygons, {.unit = spec.unit, .scale = spec.scale, .rotate = spec.rotate, .translate = spec.translate},
            Smoothing(spec.normals, spec.crease), &*connected);
        mesh->structure = build_structure(mesh->mesh, {.winding = spec.inside == InsideTest::winding});
    });
    const std::string made = fmt::format("{} {} {}", file.sha256, weld, static_cast<int>(spec.orient));
    const auto known = findings.find(made);
    ShapeFindings shape = known != findings.end() ? ShapeFindings{known->second, {}} : inspect_shape(file.polygons);
    refuse_if_meaningless(shape.findings, spec.file);
    prepared.get();
    if (known == findings.end()) {
        if (shape.findings.facets <= kSelfIntersectionTriangles && keeps_clear(spec, shape.findings, mesh->structure))
            shape.findings.self_intersections = 0;
        else
            find_self_intersections(file.polygons, shape);
        shape.findings = with_connections(std::move(shape), *connected);
    }
    mesh->findings = std::move(shape.findings);
    mesh->findings.joined_vertices = file.joined_vertices + joined.vertices;
    mesh->findings.vanished_facets = joined.facets;
    findings.emplace(made, mesh->findings);
    mesh->inside = spec.inside == InsideTest::automatic ? inside_of(mesh->findings, mesh->structure) : spec.inside;
    if (mesh->inside == InsideTest::winding && !mesh->structure.winding)
        mesh->structure.winding = make_winding(mesh->structure);
    if (is_solid(mesh->findings))
        assume_solid(mesh->structure);
    return mesh;
}

// Barycentric shading is for triangles.
void check_mesh_fits(const Scene& scene, const SceneMesh& mesh) {
    if (scene.force.shading != Shading::barycentric)
        return;
    const PolygonSoup& polygons = mesh.mesh.polygons;
    for (std::size_t facet = 0; facet < polygons.facets(); ++facet)
        if (polygons.corners_of(facet) != 3)
            throw UsageError("shading \"barycentric\" is for triangles, and facet {} of {} has {} corners: use "
                             "\"mean_value\", which is the same on triangles",
                             facet, scene.surface.mesh.file, polygons.corners_of(facet));
}

// A default grid with a finer spacing alone shows only a part of the bump.
void warn_of_part(const Scene& scene, std::vector<std::string>& warnings) {
    const bool bump = scene.surface.kind == SurfaceKind::bump || scene.surface.kind == SurfaceKind::cylinder_bump;
    const GridSpec& grid = scene.grid;
    const double end = grid.last(0);
    if (bump && scene.field && grid.origin == GridSpec{}.origin && grid.size == GridSpec{}.size &&
        end < scene.surface.width / 2)
        warnings.push_back(
            fmt::format("the grid ends at x = {:.4g} mm, the bump at {:.4g} mm: set grid.size or grid.origin, too",
                        1e3 * end, 500 * scene.surface.width));
}

// Of the axis that suffers most.
void warn_of_coarse_grid(PreparedCase& prepared) {
    const Scene& scene = prepared.one.scene;
    if (!scene.field)
        return;
    const glm::dvec3 from = prepared.images.mesh ? prepared.images.mesh->structure.centre : glm::dvec3(0);
    const bool by_y = depends_on_y(scene);
    double farthest = 0, spacing = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double own = scene.grid.farthest(axis, from[static_cast<int>(axis)]);
        if (scene.grid.size[axis] < 2 || (axis == 1 && !by_y) || own * spacing < farthest * scene.grid.spacing[axis])
            continue;
        farthest = own;
        spacing = scene.grid.spacing[axis];
    }
    if (const auto warning = coarse_warning(scene.precision, farthest, "the grid's spacing", spacing))
        prepared.warnings.push_back(*warning);
}

// Against a coefficient that only the file gives; otherwise the scene is checked.
void check_friction(const PreparedCase& prepared) {
    const Scene& scene = prepared.one.scene;
    if (!scene.friction || !scene.friction->static_coefficient)
        return;
    if (const double least = friction_coefficient(prepared); *scene.friction->static_coefficient < least)
        throw UsageError("friction.static_coefficient {:g} is less than the coefficient {:g} that {} leads to: give a "
                         "larger one, or friction.coefficient",
                         *scene.friction->static_coefficient, least, scene.vibration->file);
}

} // namespace

void check_digest(const std::string& file, const std::string& stated, const std::string& found) {
    if (!stated.empty() && stated != found)
        throw UsageError("{} is not the file that the scene means: its SHA-256 is {}, the scene says {}", file, found,
                         stated);
}

std::shared_ptr<const HeightImage> CasePreparation::image(HeightMapSpec& map) {
    if (map.function != MapFunction::file)
        return nullptr;
    require_file(map);
    const auto image = cached(images_, map.path, kImages,
                              [&] { return std::make_shared<const HeightImage>(read_height_image(map.path)); });
    check_digest(map.file, map.sha256, image->sha256);
    map.sha256 = image->sha256;
    return image;
}

std::shared_ptr<const SceneMesh> CasePreparation::mesh(MeshSpec& spec, const PolygonFile* given) {
    MeshSpec placed = spec;
    placed.sha256.clear();
    const auto read = [&] {
        const bool large = !given && may_be_kept(placed.path);
        if (auto kept = large ? kept_mesh(placed, sha256_of_file(placed.path)) : nullptr)
            return kept;
        const std::shared_ptr<const SceneMesh> made = read_scene_mesh(placed, given, findings_);
        if (large && (!keeping_.valid() || keeping_.wait_for(std::chrono::seconds(0)) == std::future_status::ready))
            keeping_ = std::async(std::launch::async, [placed, made] { keep_mesh(placed, *made); });
        return made;
    };
    const auto mesh = given ? read() : cached(meshes_, placed, kMeshes, read);
    check_digest(spec.file, spec.sha256, mesh->sha256);
    spec.sha256 = mesh->sha256;
    return mesh;
}

// Keys that it lacks are as with the scene's own mesh.
std::shared_ptr<const SceneMesh> CasePreparation::compared_mesh(Scene& scene) {
    CompareSpec& compare = *scene.compare;
    MeshSpec spec = scene.surface.kind == SurfaceKind::mesh ? scene.surface.mesh : MeshSpec{};
    static_cast<FileSpec&>(spec) = compare.file;
    spec.normals = NormalWeights::plain;
    spec.unit = compare.unit.value_or(spec.unit);
    spec.scale = compare.scale.value_or(spec.scale);
    spec.rotate = compare.rotate.value_or(spec.rotate);
    spec.translate = compare.translate.value_or(spec.translate);
    const std::shared_ptr<const SceneMesh> read = mesh(spec);
    compare.file.sha256 = spec.sha256;
    return read;
}

std::shared_ptr<const VibrationModels> CasePreparation::vibration(VibrationSpec& spec) {
    require_file(spec);
    const std::string digest = sha256_of_file(spec.path);
    check_digest(spec.file, spec.sha256, digest);
    spec.sha256 = digest;
    return cached(vibrations_, digest, kVibrations,
                  [&] { return std::make_shared<const VibrationModels>(read_vibration(spec.path)); });
}

double friction_coefficient(const PreparedCase& prepared) {
    const FrictionSpec friction = prepared.one.scene.friction.value_or(FrictionSpec{});
    const auto& vibration = prepared.images.vibration;
    const bool of_file = vibration && std::isfinite(vibration->friction);
    return friction.coefficient.value_or(of_file ? vibration->friction : kFrictionCoefficient);
}

PreparedCase CasePreparation::prepare(const Case& one, const PolygonFile* given) {
    const Clock::time_point start = Clock::now();
    PreparedCase prepared;
    prepared.one = one;
    Scene& scene = prepared.one.scene;
    if (scene.surface.kind == SurfaceKind::height_map)
        prepared.images.map = image(scene.surface.map);
    if (scene.texture)
        prepared.images.texture = image(scene.texture->map);
    if (scene.vibration)
        prepared.images.vibration = vibration(*scene.vibration);
    check_friction(prepared);
    warn_of_part(scene, prepared.warnings);
    if (scene.surface.kind == SurfaceKind::mesh) {
        prepared.images.mesh = mesh(scene.surface.mesh, given);
        const bool winding = prepared.images.mesh->inside == InsideTest::winding;
        prepared.warnings = warnings_of(scene.surface.mesh, *prepared.images.mesh,
                                        winding ? MeshUse::winding_field : MeshUse::pseudonormal_field);
        set_inside(prepared.one, prepared.images.mesh->inside);
        check_mesh_fits(scene, *prepared.images.mesh);
        if (scene.grid.samples)
            scene.grid = fitted_grid(scene.grid.samples, prepared.images.mesh->mesh);
    }
    warn_of_coarse_grid(prepared);
    if (scene.compare && scene.compare->kind == CompareKind::mesh)
        prepared.compared_mesh = compared_mesh(scene);
    prepared.scene = resolved_toml(prepared.one);
    prepared.seconds = seconds_since(start);
    return prepared;
}

std::string too_thin_for_single(const PreparedCase& prepared) {
    constexpr double kThin = 100 * double(reference::Skin<float>::kWidth); /* of the mesh's frame, half its size */
    const auto& mesh = prepared.images.mesh;
    if (!prepared.one.chooses_precision || !mesh || !has_thin_parts(mesh->structure, kThin))
        return "";
    return fmt::format("the mesh has parts or gaps thinner than {:.2g} m, too thin for f32",
                       kThin * mesh->structure.scale);
}

PreparedCase CasePreparation::prepare_open(Case one, std::string& note, const PolygonFile* given) {
    PreparedCase prepared = prepare(one, given);
    const std::string why = too_thin_for_single(prepared);
    if (why.empty())
        return prepared;
    note = "precision: f64, since " + why;
    set_precision(one, Precision::f64);
    return prepare(one, given);
}

glm::dvec3 scene_origin(const PreparedCase& prepared) {
    return prepared.images.mesh ? origin_of(prepared.images.mesh->structure) : glm::dvec3(0);
}

std::optional<std::string> coarse_warning(Precision precision, double farthest, const std::string& what,
                                          double length) {
    constexpr double kShare = 0.01;
    if (precision != Precision::f32 || !(farthest > 0) || !std::isfinite(farthest) || !(length > 0))
        return std::nullopt;
    const double ulp = std::ldexp(1.0, std::ilogb(farthest) - 23); /* m */
    if (ulp <= kShare * length)
        return std::nullopt;
    return fmt::format(
        "single precision rounds coordinates of {:.3g} m to {:.2g} m, and {} is {:.2g} m: use --precision f64",
        farthest, ulp, what, length);
}

template <typename T> double largest_coordinate(const PreparedCase& prepared) {
    if (!prepared.images.mesh)
        return kLargestLength<T>;
    const MeshStructure& mesh = prepared.images.mesh->structure;
    const double middle = std::max({std::abs(mesh.centre.x), std::abs(mesh.centre.y), std::abs(mesh.centre.z)});
    return std::min(kLargestLength<T>, middle + kMeshReach<T> * mesh.scale);
}
template double largest_coordinate<float>(const PreparedCase&);
template double largest_coordinate<double>(const PreparedCase&);

} // namespace forceshade
