#include "host/study/error_time/subject.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <glm/vec2.hpp>

#include "host/reference/elementary.h"
#include "host/touch/force_errors.h"
#include "host/touch/own_surfaces.h"

namespace forceshade::study::error_time {
namespace {

constexpr std::uint64_t kLongestSide = 64;       // voxels of a kernel's grid over a user's scene
constexpr double kMostSamples = 6e6;             // of a volume
constexpr double kMostMeshSamples = 1e6;         // of a mesh, whose samples take longer
constexpr unsigned kThoroughFacets = 64;         // of the own bump that all methods are measured on
constexpr unsigned kThoroughCells = 16;          // the same for the own mesh
constexpr std::size_t kPaths = 64, kSteps = 500; // of closed loops

// Of a studied surface, as prepared.
PreparedCase own_scene(const StudiedSurface& studied, const PreparedCase& prepared,
                       const std::array<std::uint64_t, 3>& samples) {
    PreparedCase own = prepared;
    own.one.scene.grid = grid_over(studied.volume, samples);
    PathsSpec& paths = own.one.scene.paths.emplace();
    paths.speed = {Spread::Shape::normal, 0.06, 0.015}; // m/s
    if (prepared.images.mesh)                           // its middle half, whatever stands around
        paths.length = paths.width = kOwnHalfWidth;
    return own;
}

void set_grid(Subject& subject, const GridSpec& grid) {
    subject.grid = grid;
    subject.set_box(grid);
}

// The same box by other samples along the axes that differ.
void resample(Subject& subject, std::array<std::uint64_t, 3> size) {
    for (int i = 0; i < 3; ++i) {
        const auto axis = static_cast<std::size_t>(i);
        if (subject.grid.size[axis] == size[axis])
            continue;
        subject.grid.size[axis] = size[axis];
        subject.grid.origin[axis] = subject.low[i];
        subject.grid.spacing[axis] = (subject.high[i] - subject.low[i]) / static_cast<double>(size[axis] - 1);
    }
}

Variant variant_of(const Subject& subject, const PreparedCase& base, std::optional<double> elements,
                   const NamedShading& shading) {
    auto prepared = std::make_shared<PreparedCase>(base);
    Scene& scene = prepared->one.scene;
    scene.force.shading = shading.first;
    if (!scene.paths || scene.paths->kind == PathKind::recorded)
        scene.paths.emplace();
    scene.paths->count = kPaths;
    scene.paths->steps = kSteps;
    if (!scene.paths->closed() || scene.paths->drive == PathDrive::depth)
        scene.paths->drive = PathDrive::press;
    scene.paths->loop.reset();
    const std::string name =
        elements ? fmt::format("{} {}, {}", *elements, subject.elements, shading.second) : shading.second;
    return {name, std::move(prepared), shading.second, elements};
}

// A law of the subject for each shading of a surface; `drawn`: the same surface, tessellated anew.
void add_variants(Subject& subject, const PreparedCase& base, std::optional<double> elements,
                  const std::function<bool(Shading)>& thorough, const std::vector<PreparedCase>& drawn = {}) {
    for (const NamedShading& shading : shadings_of(base)) {
        Variant& variant = subject.variants.emplace_back(variant_of(subject, base, elements, shading));
        variant.thorough = thorough(shading.first);
        for (const PreparedCase& one : drawn)
            variant.drawn.push_back(variant_of(subject, one, elements, shading));
    }
}

// The force K (R - r) along the cylinder's radius.
ForceAt mesh_truth(const Scene& scene) {
    return [own = SmoothCylinder(scene)](const TouchPlace& place) {
        const glm::dvec3 from_axis(place.at.x, 0, place.at.z + own.centre_depth);
        const double r = reference::length(from_axis);
        return r < own.radius && r > 0 ? own.stiffness * (own.radius - r) / r * from_axis : glm::dvec3(0);
    };
}

std::vector<double> spacings_within(const Subject& subject, std::vector<double> spacings, double most) {
    const glm::dvec3 size = subject.high - subject.low;
    std::erase_if(spacings, [&](double h) { return (size.x / h + 5) * (size.y / h + 5) * (size.z / h + 5) > most; });
    return spacings;
}

std::vector<TouchPlace> drawn_places(const Subject& subject, const Extents& extents, std::size_t draw) {
    const PreparedCase& finest = *subject.variants.back().prepared;
    return touched_places(subject, finest, extents.places, subject.seed(Subject::Random::places, draw));
}

// What follows from the finest law, which comes last.
void complete(Subject& subject, const Extents& extents) {
    subject.stiffness = subject.variants.back().prepared->one.scene.force.stiffness;
    subject.places = drawn_places(subject, extents, 0);
}

Subject own_bump(const Extents& extents) {
    const StudiedSurface& studied = studied_surface("bump of 8 facets");
    const PreparedCase own = own_scene(studied, own_case(studied.own), {256, 8, 64});
    Subject subject{"bump", "facets"};
    subject.first_draw = extents.first_draw;
    subject.force = cylinder_force(own.one.scene);
    set_grid(subject, own.one.scene.grid);
    subject.spacings = extents.spacings;
    subject.notes = {"The bump is the paper's, R = 600 mil and W = 1000 mil on a plane, K = 1000 N/m. Its smooth shape "
                     "is the cylinder, with the force K (U(x) - z) along the normal N(x) above the probe: the depth is "
                     "read vertically, as that of the facets is."};
    for (const unsigned facets : extents.facets) {
        PreparedCase prepared = own;
        prepared.one.scene.surface.facets = facets;
        add_variants(subject, prepared, facets, [&](Shading) { return facets == kThoroughFacets; });
    }
    complete(subject, extents);
    return subject;
}

Subject own_mesh(const Extents& extents) {
    const StudiedSurface& studied = studied_surface("mesh");
    const auto prepared_of = [&](const PreparedCase& prepared) { return own_scene(studied, prepared, {64, 32, 32}); };
    Subject subject{"mesh", "cells"};
    subject.first_draw = extents.first_draw;
    subject.notes = {"The meshes are blocks under the same cylinder, whose top is cut into triangles between equal "
                     "arcs. Their smooth shape has the force K (R - r) along the radius: the depth is that of the "
                     "nearest point, as the meshes' is."};
    for (const unsigned cells : extents.cells) {
        OwnSurface surface = studied.own;
        surface.facets = surface.rows = cells;
        const PreparedCase own = prepared_of(own_case(surface));
        const SmoothCylinder smooth(own.one.scene);
        if (!subject.force) {
            subject.force = mesh_truth(own.one.scene);
            set_grid(subject, own.one.scene.grid);
            subject.spacings = spacings_within(subject, extents.spacings, kMostMeshSamples);
        }
        const double reach =
            std::hypot(smooth.radius * std::asin(studied.volume.high.x / smooth.radius), studied.volume.high.y) +
            1e-3; // m
        std::vector<PreparedCase> drawn;
        for (std::size_t draw = 1; draw < extents.draws; ++draw) {
            drawn.push_back(own);
            drawn.back().images.mesh =
                cylinder_patch({smooth.half, smooth.radius, cells, cells},
                               DrawnPatch{reach, subject.seed(Subject::Random::tessellation, draw)});
        }
        const auto thorough = [&](Shading shading) {
            return cells == kThoroughCells && (shading == Shading::none || shading == Shading::mean_value);
        };
        add_variants(subject, own, cells, thorough, drawn);
    }
    complete(subject, extents);
    return subject;
}

} // namespace

Extents extents_of(bool quick) {
    if (quick)
        return {{1, 4, 8, 64, 512}, {4, 8, 16, 32}, {0.8e-3, 0.4e-3, 0.2e-3}, 1000, 150, 7, 5, 3, 100, 10};
    const std::vector<unsigned> facets{1, 2, 3, 4, 8, 16, 32, 64, 128, 512, 4096}, cells{4, 8, 16, 32, 64};
    return {facets, cells, {0.8e-3, 0.4e-3, 0.2e-3, 0.1e-3}, 4000, 500, 20, 12, 9, 1000, 50};
}

std::vector<Subject> own_subjects(const Extents& extents) {
    return {own_bump(extents), own_mesh(extents)};
}

Subject scene_subject(const PreparedCase& given, const Extents& extents) {
    PreparedCase scene = given;
    Scene& own = scene.one.scene;
    const bool bump = own.surface.kind == SurfaceKind::bump, mesh = own.surface.kind == SurfaceKind::mesh;
    if (!own.field && mesh) // of paths alone: no grid was given
        own.grid = fitted_grid(kLongestSide, scene.images.mesh->mesh);
    Subject subject("scene", bump ? "facets" : "");
    subject.first_draw = extents.first_draw;
    set_grid(subject, own.grid);
    subject.scale = scene_shape(scene).scale;
    subject.grid.samples = 0;
    std::array<std::uint64_t, 3> fewer = own.grid.size;
    for (std::uint64_t& count : fewer)
        count = std::min(count, kLongestSide);
    resample(subject, fewer);
    const double finest = *std::ranges::min_element(own.grid.spacing);
    subject.spacings =
        spacings_within(subject, {8 * finest, 4 * finest, 2 * finest, finest}, mesh ? kMostMeshSamples : kMostSamples);
    subject.against = set_true_force(subject, scene);
    subject.notes.push_back(
        subject.smooth
            ? "The smooth shape is the cylinder of the scene's radius and width, with the force K d along the normal "
              "above the probe, the depth read as the scene reads it."
            : fmt::format("No smooth shape of this scene is known: errors are against {}, one of the laws, not the "
                          "truth. They say how far apart methods and shadings are, not which of them is right.",
                          subject.against));
    add_variants(subject, scene, bump ? std::optional<double>(own.surface.facets) : std::nullopt,
                 [&](Shading shading) { return shading == own.force.shading; });
    complete(subject, extents);
    return subject;
}

// Kinds of places.
namespace {

constexpr std::size_t kTriesOfKinds = 100, kTriesOfRare = 10; // draws for each place of a kind
constexpr double kSmoothTurn = 5 * kDegree;                   // across a ring; more is an edge of the smooth shape
constexpr double kFacetTurn = 0.5 * kDegree;                  // across a ring; less is not an edge of facets
constexpr double kFlatTurn = 0.01 * kDegree;                  // across a ring; more is curved
constexpr std::size_t kRing = 8;                              // places of a ring

PreparedCase unshaded(PreparedCase prepared) {
    prepared.one.scene.force.shading = Shading::none;
    prepared.one.scene.texture.reset();
    return prepared;
}

// rad: the largest turn of a force on a ring of that radius about the place.
template <typename Force> double turn_about(const TouchPlace& place, double radius, const Force& force_at) {
    static const auto ring = [] { // cosines and sines
        std::array<glm::dvec2, kRing> directions{};
        for (std::size_t i = 0; i < kRing; ++i) {
            const double angle = 2 * std::numbers::pi * static_cast<double>(i) / kRing;
            directions[i] = {std::cos(angle), std::sin(angle)};
        }
        return directions;
    }();
    const std::pair<glm::dvec3, glm::dvec3> across = directions_across(place.normal);
    const glm::dvec3 middle = force_at(place);
    double largest = 0;
    for (const glm::dvec2& direction : ring) {
        TouchPlace near = place;
        near.at += radius * (direction.x * across.first + direction.y * across.second);
        if (const glm::dvec3 force = force_at(near); touches(force) && touches(middle))
            largest = std::max(largest, angle_between(middle, force));
    }
    return largest;
}

} // namespace

const char* name_of(Kind kind) {
    constexpr const char* kNames[] = {"flat", "facet", "edge", "rim", "boundary"};
    return kNames[static_cast<std::size_t>(kind)];
}

KindOf::KindOf(const Subject& subject, const Variant& variant)
    : subject_(subject), plain_(unshaded(*variant.prepared)), facets_(plain_) {}

double smooth_turn(const Subject& subject, const TouchPlace& place) {
    return turn_about(place, subject.scale.ring(), subject.force);
}

Kind KindOf::of(const TouchPlace& place, double smooth_turn) {
    if (smooth_turn > kSmoothTurn)
        return Kind::rim;
    const double facet_turn = turn_about(place, subject_.scale.ring(),
                                         [&](const TouchPlace& at) { return facets_.force(facets_.input(at)); });
    if (facet_turn > kFacetTurn)
        return Kind::edge;
    if (place.depth < subject_.scale.skin())
        return Kind::boundary;
    return smooth_turn < kFlatTurn && facet_turn < kFlatTurn ? Kind::flat : Kind::facet;
}

const std::optional<std::pair<TouchPlace, double>>& DrawnPlaces::operator[](std::size_t tries) {
    while (found_.size() <= tries) {
        const std::optional<TouchPlace> place = draw_();
        found_.emplace_back();
        if (place)
            found_.back().emplace(*place, smooth_turn(subject_, *place));
    }
    return found_[tries];
}

SharedPlaces shared_places(const Subject& subject, const Extents& extents, std::size_t draw) {
    SharedPlaces shared;
    shared.at = draw == 0 ? subject.places : drawn_places(subject, extents, draw);
    for (const TouchPlace& place : shared.at)
        shared.turns.push_back(smooth_turn(subject, place));
    return shared;
}

KindPlaces places_of(const Subject& subject, const Variant& variant, SharedPlaces& shared, const Extents& extents,
                     std::size_t draw) {
    KindOf kind_of(subject, variant);
    KindPlaces all{{}, {}, shared.at.size()};
    std::array<std::size_t, kKinds.size()> counts{};
    const auto add = [&](const TouchPlace& place, Kind kind) {
        all.at.push_back(place);
        all.kinds.push_back(kind);
        ++counts[static_cast<std::size_t>(kind)];
    };
    for (std::size_t i = 0; i < shared.at.size(); ++i)
        add(shared.at[i], kind_of.of(shared.at[i], shared.turns[i]));
    if (!shared.further || variant.prepared->images.mesh)
        shared.further.emplace(subject, *variant.prepared, subject.seed(Subject::Random::kinds, draw));
    const std::size_t wanted = extents.places_of_kind;
    for (std::size_t tries = 0; tries < kTriesOfKinds * wanted; ++tries) {
        const bool early = tries < kTriesOfRare * wanted; // a kind not met by then does not exist
        if (std::ranges::all_of(counts, [&](std::size_t count) { return count >= wanted || (count == 0 && !early); }))
            break;
        if (const auto& found = (*shared.further)[tries])
            if (const Kind kind = kind_of.of(found->first, found->second);
                counts[static_cast<std::size_t>(kind)] < wanted)
                add(found->first, kind);
    }
    // As many places up to a skin above the surface: there should be no force.
    for (std::size_t i = 0, end = all.at.size(); i < end; ++i)
        if (all.kinds[i] == Kind::boundary) {
            TouchPlace above = all.at[i];
            const double skin = subject.scale.skin(), shallowest = subject.scale.shallowest();
            above.depth = -skin * (above.depth - shallowest) / (skin - shallowest);
            above.at += (all.at[i].depth - above.depth) * above.normal;
            if (!touches(subject.force(above)))
                add(above, Kind::boundary);
        }
    return all;
}

} // namespace forceshade::study::error_time
