#include "host/cases/case_files.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <system_error>
#include <type_traits>
#include <vector>

#include <fmt/format.h>

#include "host/field/case_law.h"
#include "host/field/comparison.h"
#include "host/output/raw_formats.h"
#include "host/picture/picture.h"
#include "host/picture/values.h"
#include "host/program.h"
#include "host/reference/contact.h"
#include "host/reference/motion.h"

namespace forceshade {

namespace {

constexpr std::uint32_t kMostStrips = 1024; // of a bump's facets
constexpr std::uint64_t kMostParts = 512;   // along an axis, of what is cut
constexpr std::size_t kMostCorners = 256;   // of a facet, that a picture presses

// deg: by how much shading turns a force; 0 without one.
double turn_of(const glm::dvec3& force, const glm::dvec3& unshaded) {
    const double turn = picture::value_of(picture::Quantity::angle, {force.x, force.y, force.z},
                                          {unshaded.x, unshaded.y, unshaded.z}, {0, 2, 1});
    return turn == picture::kNoForce ? 0 : turn;
}

// The file, and what is to be written next.
template <typename T> class SurfaceFile {
public:
    SurfaceFile(const std::filesystem::path& path, const PreparedCase& prepared, std::uint64_t points,
                std::uint64_t cells, std::uint64_t corners, double pressed)
        : file_(make_vtp(path, polygons_of(points, cells, corners, pressed, prepared.one.scene.compare.has_value()))) {
        if (prepared.one.scene.compare)
            comparison_.emplace(prepared);
    }

    // `probe`: where the contact is felt, m.
    void add_point(const glm::dvec3& place, const glm::dvec3& probe, const reference::Contact<T>& contact) {
        append(points_, place);
        append(force_, contact.force);
        append(unshaded_, contact.unshaded);
        const glm::dvec3 force(contact.force), unshaded(contact.unshaded);
        turn_.push_back(static_cast<T>(turn_of(force, unshaded)));
        if (comparison_) {
            const Deviation deviation = comparison_->at(probe, force, hint_);
            angle_.push_back(static_cast<T>(deviation.angle));
            magnitude_error_.push_back(static_cast<T>(deviation.magnitude_error));
        }
        if (turn_.size() == kAtOnce)
            flush_points();
    }
    void add_cell(std::span<const std::int64_t> corners, std::uint32_t facet) {
        corners_.insert(corners_.end(), corners.begin(), corners.end());
        corners_before_ += static_cast<std::int64_t>(corners.size());
        ends_.push_back(corners_before_);
        facets_.push_back(static_cast<std::int32_t>(facet));
        if (facets_.size() == kAtOnce)
            flush_cells();
    }
    VolumeResult finish() {
        flush_points();
        flush_cells();
        return file_.finish();
    }

private:
    static constexpr std::size_t kAtOnce = 4096; // points or cells

    static PolyData polygons_of(std::uint64_t points, std::uint64_t cells, std::uint64_t corners, double pressed,
                                bool compared) {
        PolyData data;
        data.points = points;
        data.cells = cells;
        data.corners = corners;
        data.point_data = {{"force", vtk_type<T>(), 3, points},
                           {"unshaded", vtk_type<T>(), 3, points},
                           {"turn", vtk_type<T>(), 1, points}};
        for (const std::uint32_t channel : {kChannelAngle, kChannelMagnitudeError})
            if (compared)
                data.point_data.push_back({name_of_channel(channel), vtk_type<T>(), 1, points});
        data.cell_data = {{"facet", vtk_type<std::int32_t>(), 1, cells}};
        data.active_points = "Vectors=\"force\" Scalars=\"turn\"";
        data.active_cells = "Scalars=\"facet\"";
        data.field_data = fmt::format("<FieldData>\n<DataArray type=\"Float64\" Name=\"pressed_m\" "
                                      "NumberOfTuples=\"1\" format=\"ascii\">{}</DataArray>\n</FieldData>\n",
                                      pressed);
        return data;
    }

    template <typename Real> static void append(std::vector<Real>& values, const glm::vec<3, Real>& vector) {
        values.insert(values.end(), {vector.x, vector.y, vector.z});
    }
    template <typename Value> void flush(const char* name, std::vector<Value>& values) {
        file_.write(name, std::as_bytes(std::span(values)));
        values.clear();
    }
    void flush_points() {
        check_interrupt();
        flush("Points", points_);
        flush("force", force_);
        flush("unshaded", unshaded_);
        flush("turn", turn_);
        if (!comparison_)
            return;
        flush(name_of_channel(kChannelAngle), angle_);
        flush(name_of_channel(kChannelMagnitudeError), magnitude_error_);
    }
    void flush_cells() {
        flush("connectivity", corners_);
        flush("offsets", ends_);
        flush("facet", facets_);
    }

    VtkFile file_;
    std::vector<double> points_;
    std::vector<T> force_, unshaded_, turn_, angle_, magnitude_error_;
    std::optional<ShapeComparison> comparison_; // with [compare]
    layout::uint hint_ = 0;                     // for it
    std::vector<std::int64_t> corners_, ends_;
    std::vector<std::int32_t> facets_;
    std::int64_t corners_before_ = 0;
};

// A probe that touches a mesh's facet and is pressed along its normal.
template <typename T> class FacetPress {
public:
    explicit FacetPress(const PreparedCase& prepared)
        : mesh_(prepared.images.mesh->mesh),
          tables_(make_tables<T>(prepared.one.scene, prepared.images, Extent::nothing)), law_(tables_.law()),
          distance_(static_cast<T>(pressed_depth(prepared) / prepared.images.mesh->structure.scale)) {}

    reference::Vector<T> normal(std::uint32_t facet) const {
        return reference::vector_at(law_.mesh.facet_normals, facet);
    }
    // `place` in the mesh's frame; no force on a facet that no probe touches.
    reference::Contact<T> at(std::uint32_t facet, const reference::Vector<T>& place) const {
        if (normal(facet) == reference::Vector<T>(T(0)) || std::ranges::binary_search(mesh_.redundant_facets, facet))
            return {};
        return reference::touching_contact(law_,
                                           reference::MeshTouch<T>{facet, distance_ * normal(facet), place, distance_});
    }
    // The place of a facet's corner.
    reference::Vector<T> corner(std::uint32_t corner) const {
        return reference::vector_at(law_.mesh.vertices, law_.mesh.facet_corners[corner]);
    }

private:
    const Mesh& mesh_;
    FieldTables<T> tables_;
    layout::Law<T> law_;
    T distance_;
};

template <typename T> VolumeResult write_mesh(const std::filesystem::path& path, const PreparedCase& prepared) {
    const PolygonSoup& polygons = prepared.images.mesh->mesh.polygons;
    const double pressed = pressed_depth(prepared);
    const std::uint64_t corners = polygons.corners.size();
    SurfaceFile<T> file(path, prepared, corners, polygons.facets(), corners, pressed);
    const FacetPress<T> press(prepared);
    for (std::uint32_t facet = 0; facet < polygons.facets(); ++facet) {
        std::vector<std::int64_t> outline;
        for (std::uint32_t corner = polygons.begins[facet]; corner < polygons.begins[facet + 1]; ++corner) {
            const glm::dvec3& place = polygons.vertices[polygons.corners[corner]];
            file.add_point(place, place - pressed * glm::dvec3(press.normal(facet)),
                           press.at(facet, press.corner(corner)));
            outline.push_back(corner);
        }
        file.add_cell(outline, facet);
    }
    return file.finish();
}

// Along an axis: the grid, and half a step beyond a lone sample.
struct Range {
    double low, high; /* m */
};

Range range_of(const GridSpec& grid, std::size_t axis) {
    const double low = grid.origin[axis], spacing = grid.spacing[axis];
    if (grid.size[axis] < 2)
        return {low - spacing / 2, low + spacing / 2};
    return {low, low + spacing * static_cast<double>(grid.size[axis] - 1)};
}

bool force_depends_on_y(const Scene& scene) {
    layout::Features features = features_of(scene);
    features.channels = layout::kChannelForce;
    return depends_on_y(features);
}

std::uint64_t parts_along_y(const Scene& scene) {
    return force_depends_on_y(scene) ? std::clamp<std::uint64_t>(scene.grid.size[1] - 1, 1, kMostParts) : 1;
}

bool is_bump(const Scene& scene) {
    return scene.surface.kind == SurfaceKind::bump;
}

// A part of the surface's section: a facet or several, or a plane.
template <typename T> struct Piece {
    T from, to; /* m: x */
    std::uint32_t facet;
};

template <typename T> std::vector<Piece<T>> pieces_of(const Scene& scene, const layout::Law<T>& law) {
    const Range x = range_of(scene.grid, 0);
    const auto low = static_cast<T>(x.low), high = static_cast<T>(x.high);
    if (scene.surface.kind == SurfaceKind::height_map)
        return {{low, high, 0}};
    const T half_width = law.params.half_width;
    const std::uint32_t plane = is_bump(scene) ? law.params.facets : 1;
    std::vector<Piece<T>> pieces{{low, -half_width, plane}};
    if (is_bump(scene)) {
        const std::uint64_t strips = std::min(law.params.facets, kMostStrips);
        for (std::uint64_t strip = 0; strip < strips; ++strip) {
            const std::uint64_t first = strip * law.params.facets / strips,
                                end = (strip + 1) * law.params.facets / strips;
            pieces.push_back({law.facet_vertices[first], law.facet_vertices[end], static_cast<std::uint32_t>(first)});
        }
    } else
        pieces.push_back({-half_width, half_width, 0});
    pieces.push_back({half_width, high, plane});
    std::erase_if(pieces, [](const Piece<T>& piece) { return !(piece.from < piece.to); });
    if (pieces.empty()) // all is one number of T
        pieces.push_back({low, high, plane});
    return pieces;
}

// Where a section has points.
template <typename T> struct Station {
    T x;      /* m */
    T inside; /* m: where its law is evaluated: at an end of a piece as little within it as can be, not beyond an edge
               */
    std::uint32_t facet;
    bool last; /* of its piece: no polygon follows */
};

template <typename T> std::vector<Station<T>> stations_of(const Scene& scene, const layout::Law<T>& law) {
    const std::vector<Piece<T>> pieces = pieces_of(scene, law);
    const layout::Features& features = law.features;
    const bool alike =
        is_bump(scene) && features.shading == layout::kShadingNone && features.texture == layout::kMapNone;
    const double step =
        std::max(scene.grid.spacing[0], (double(pieces.back().to) - double(pieces.front().from)) / double(kMostParts));
    std::vector<Station<T>> stations;
    for (const auto& [from, to, facet] : pieces) {
        constexpr double kRounding = 1e-3; // of a step
        const double width = double(to) - double(from);
        const double parts = alike ? 1 : std::max(std::ceil(width / step - kRounding), 1.0);
        stations.push_back({from, std::nextafter(from, to), facet, false});
        for (double part = 1; part < parts; ++part) {
            const auto x = static_cast<T>(double(from) + width * part / parts);
            stations.push_back({x, x, facet, false});
        }
        stations.push_back({to, std::nextafter(to, from), facet, true});
    }
    return stations;
}

template <typename T> VolumeResult write_section(const std::filesystem::path& path, const PreparedCase& prepared) {
    const Scene& scene = prepared.one.scene;
    const CaseLaw<T> law(prepared);
    const std::vector<Station<T>> stations = stations_of(scene, law.law());
    const auto count = static_cast<std::int64_t>(stations.size());
    const auto strips = static_cast<std::uint64_t>(
        std::ranges::count_if(stations, [](const Station<T>& station) { return !station.last; }));
    const std::uint64_t parts = parts_along_y(scene);
    const double pressed = pressed_depth(prepared);
    const Range range = range_of(scene.grid, 1);
    SurfaceFile<T> file(path, prepared, stations.size() * (parts + 1), strips * parts, 4 * strips * parts, pressed);
    for (std::uint64_t row = 0; row <= parts; ++row) {
        const auto y = static_cast<T>(std::lerp(range.low, range.high, double(row) / double(parts)));
        for (const Station<T>& station : stations) {
            const T height = reference::nominal_height(law.law(), station.inside);
            const reference::Vector<T> probe(station.inside, y, height - static_cast<T>(pressed));
            layout::uint hint = 0;
            file.add_point({station.x, y, height}, glm::dvec3(probe), law.at_rounded(probe, hint));
        }
        const std::int64_t first = static_cast<std::int64_t>(row) * count;
        for (std::int64_t i = 0; row < parts && i < count; ++i)
            if (const Station<T>& station = stations[static_cast<std::size_t>(i)]; !station.last)
                file.add_cell(std::array{first + i, first + i + 1, first + count + i + 1, first + count + i},
                              station.facet); // counterclockwise seen from above
    }
    return file.finish();
}

} // namespace

VolumeResult write_surface(const std::filesystem::path& path, const PreparedCase& prepared) {
    return in_precision(prepared.one.scene.precision, [&]<typename T>(std::type_identity<T>) {
        return prepared.images.mesh ? write_mesh<T>(path, prepared) : write_section<T>(path, prepared);
    });
}

picture::TurnedMesh mesh_turns(const PreparedCase& prepared, Shading shading) {
    PreparedCase shaded = prepared;
    shaded.one.scene.force.shading = shading;
    const Mesh& mesh = prepared.images.mesh->mesh;
    const std::size_t triangles = mesh.triangles.corners.size();
    constexpr double kParts = 2e5, kMostParts = 48;
    picture::TurnedMesh turned;
    turned.parts = static_cast<unsigned>(std::clamp(std::sqrt(kParts / double(triangles)), 1.0, kMostParts));
    turned.turns.reserve(triangles * turned.parts * turned.parts);
    const FacetPress<double> press(shaded);
    std::uint32_t facet = ~0u, of_facet = 0;
    for (std::size_t triangle = 0; triangle < triangles; ++triangle) {
        of_facet = mesh.triangles.facets[triangle] == facet ? of_facet + 1 : 0;
        facet = mesh.triangles.facets[triangle];
        // Shading takes time linear in the corners, and so all of a facet's triangles quadratic time.
        if (of_facet % (mesh.polygons.corners_of(facet) / kMostCorners + 1) != 0) {
            const std::size_t before = turned.turns.size() - turned.parts * turned.parts;
            for (std::size_t part = before; part < before + turned.parts * turned.parts; ++part)
                turned.turns.push_back(turned.turns[part]);
            continue;
        }
        std::array<glm::dvec3, 3> corners;
        std::ranges::transform(mesh.triangles.corners[triangle], corners.begin(), [&](std::uint32_t vertex) {
            return to_mesh_frame(prepared.images.mesh->structure, mesh.polygons.vertices[vertex]);
        });
        picture::for_each_part(turned.parts, [&](const auto& shares) {
            glm::dvec3 place = corners[0];
            for (const auto& [v, w] : shares)
                place += (v * (corners[1] - corners[0]) + w * (corners[2] - corners[0])) / 3.0;
            const reference::Contact<double> contact = press.at(facet, place);
            turned.turns.push_back(static_cast<float>(turn_of(contact.force, contact.unshaded)));
        });
        check_interrupt();
    }
    return turned;
}

double most_surface_bytes(const Scene& scene) {
    const double real = scene.precision == Precision::f64 ? 8 : 4;
    const double point = 3 * 8 + (3 + 3 + 1 + (scene.compare ? 2 : 0)) * real; // place, force, unshaded, turn, compared
    const double corner = 8, cell = 8 + 4;                                     // connectivity; offset, facet
    if (scene.surface.kind == SurfaceKind::mesh) {
        constexpr double kTriangle = 19; // bytes of a triangle in a binary PLY file, half a vertex included
        std::error_code error;
        const std::uintmax_t bytes = std::filesystem::file_size(scene.surface.mesh.path, error);
        return error ? 0 : static_cast<double>(bytes) / kTriangle * (3 * (point + corner) + cell);
    }
    constexpr double kPlanes = 2; // beside a bump
    const double pieces = is_bump(scene) ? std::min(scene.surface.facets, kMostStrips) + kPlanes : 1 + kPlanes;
    const double strips = pieces + double(kMostParts), parts = static_cast<double>(parts_along_y(scene));
    return (strips + pieces) * (parts + 1) * point + strips * parts * (4 * corner + cell);
}

} // namespace forceshade
