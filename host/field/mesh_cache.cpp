#include "host/field/mesh_cache.h"

#include <atomic>
#include <span>
#include <type_traits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/mesh/clearance.h"
#include "host/output/kept.h"
#include "host/program.h"

namespace forceshade {

namespace {

constexpr std::size_t kLeastTriangles = 50'000;
constexpr std::uintmax_t kLeastBytes = 10 * kLeastTriangles; // of a file: packed ones have more a triangle
constexpr std::uint64_t kMostKept = 2ull << 30;              // bytes
constexpr std::uint64_t kMostWritten = kMostKept / 2; // bytes, by this process: a long sweep would only replace them
constexpr std::uint64_t kLeastFree = 1ull << 30;      // bytes: that stay free on the disk, besides three times the mesh
constexpr const char* kKind = "mesh";

std::filesystem::path& folder() {
    static std::filesystem::path path;
    return path;
}

// All that a prepared mesh depends on.
std::string identity_of(const MeshSpec& spec, const std::string& sha256) {
    return fmt::format("{} {} {} {} {} {} {} {} {} {} {} {} {}", version(), __VERSION__, sha256,
                       std::filesystem::path(spec.path).extension().string(), spec.unit, spec.scale,
                       fmt::join(spec.rotate, " "), fmt::join(spec.translate, " "), static_cast<int>(spec.normals),
                       spec.crease, spec.weld, static_cast<int>(spec.orient), static_cast<int>(spec.inside));
}

// A mesh as its file holds it: `archive` writes or reads each part in turn.

template <typename Archive, typename Findings> void pass_findings(Archive& archive, Findings& found) {
    auto& [components, boundary, holes, crowded, odd, fans, misoriented] =
        static_cast<std::conditional_t<std::is_const_v<Findings>, const ConnectivityCounts, ConnectivityCounts>&>(
            found);
    archive(components, boundary, holes, crowded, odd, fans, misoriented);
    archive(found.vertices, found.unused_vertices, found.facets, found.triangles, found.quadrilaterals, found.others,
            found.most_corners, found.degenerate_facets, found.redundant_facets, found.opposed_facets,
            found.repeated_corner_facets, found.joined_vertices, found.vanished_facets, found.inside_out, found.nested,
            found.one_sided, found.closing_distance, found.self_intersections, found.more_self_intersections,
            found.closed, found.area, found.volume, found.low, found.high);
}

template <typename Archive, typename Polygons> void pass_polygons(Archive& archive, Polygons& polygons) {
    auto& [vertices, begins, corners, normals, groups] = polygons;
    archive(vertices, begins, corners, normals, groups);
}

template <typename Archive, typename Of> void pass_mesh(Archive& archive, Of& mesh) {
    auto& [polygons, redundant, facet_normals, vertex_normals, triangles, opposed] = mesh;
    pass_polygons(archive, polygons);
    archive(redundant, facet_normals, vertex_normals, triangles.corners, triangles.facets, triangles.normals, opposed);
}

template <typename Archive, typename Parts> void pass_parts(Archive& archive, Parts& parts) {
    auto& [nodes, slabs, corners, facets, neighbours, begins, facet_corners] = parts;
    archive(nodes, slabs, corners, facets, neighbours, begins, facet_corners);
}

template <typename Archive, typename Reals> void pass_reals(Archive& archive, Reals& reals) {
    auto& [vertices, vertex_normals, vertex_pseudonormals, triangles, facets, edges] = reals;
    archive(vertices, vertex_normals, vertex_pseudonormals, triangles, facets, edges);
}

template <typename Archive, typename Winding> void pass_winding(Archive& archive, Winding& winding) {
    auto& [moments, rims] = winding;
    archive(moments, rims);
}

class Writer {
public:
    explicit Writer(const std::filesystem::path& path) : file_(path) {}

    template <typename... Values> void operator()(const Values&... values) { (put(values), ...); }
    void publish() { file_.publish(); }

private:
    template <typename T> void put(const T& value) {
        static_assert(std::is_trivially_copyable_v<T>);
        file_.write(std::as_bytes(std::span(&value, 1)));
    }
    template <typename T> void put(const std::vector<T>& values) {
        put(values.size());
        if constexpr (std::is_trivially_copyable_v<T>)
            file_.write(std::as_bytes(std::span(values)));
        else
            for (const T& value : values)
                put(value);
    }
    void put(const std::string& text) {
        put(text.size());
        file_.write(std::as_bytes(std::span(text)));
    }
    template <typename T> void put(const std::optional<T>& value) {
        put(value.has_value());
        put(value.value_or(T()));
    }
    void put(const MeshFault& fault) { (*this)(fault.what, fault.force, fault.remedy, fault.key, fault.is_wrong); }

    KeptWriter file_;
};

class Reader {
public:
    explicit Reader(const std::filesystem::path& path) : file_(path) {}

    template <typename... Values> void operator()(Values&... values) { (get(values), ...); }
    void finish() { file_.finish(); }

private:
    template <typename T> void get(T& value) {
        static_assert(std::is_trivially_copyable_v<T>);
        file_.read(std::as_writable_bytes(std::span(&value, 1)));
    }
    // The number of elements that follow, of `bytes_each` at least: no more than the file can hold.
    std::size_t count(std::size_t bytes_each) {
        std::size_t count = 0;
        get(count);
        if (count > file_.left() / bytes_each)
            throw IoError("a kept mesh is damaged: it cannot hold {} times {} bytes", count, bytes_each);
        return count;
    }
    template <typename T> void get(std::vector<T>& values) {
        constexpr std::size_t kLeastText = sizeof(std::size_t); // bytes of an empty one
        values.resize(count(std::is_trivially_copyable_v<T> ? sizeof(T) : kLeastText));
        if constexpr (std::is_trivially_copyable_v<T>)
            file_.read(std::as_writable_bytes(std::span(values)));
        else
            for (T& value : values)
                get(value);
    }
    void get(std::string& text) {
        text.resize(count(1));
        file_.read(std::as_writable_bytes(std::span(text)));
    }
    template <typename T> void get(std::optional<T>& value) {
        bool known = false;
        T found{};
        (*this)(known, found);
        if (known)
            value = found;
    }
    void get(MeshFault& fault) { (*this)(fault.what, fault.force, fault.remedy, fault.key, fault.is_wrong); }

    KeptReader file_;
};

std::shared_ptr<const SceneMesh> read(const std::filesystem::path& path, const MeshSpec& spec,
                                      const std::string& identity) {
    Reader file(path);
    std::string of;
    file(of);
    if (of != identity)
        return nullptr;
    auto mesh = std::make_shared<SceneMesh>();
    MeshStructure& structure = mesh->structure;
    auto parts = std::make_shared<MeshParts>();
    auto reals = std::make_shared<MeshReals<double>>();
    bool has_winding = false, has_clearance = false, is_clear = false;
    file(mesh->sha256, mesh->format, mesh->file_triangles, mesh->inside, mesh->changes);
    pass_findings(file, mesh->findings);
    pass_mesh(file, mesh->mesh);
    file(structure.centre, structure.scale, structure.solid, has_winding, has_clearance, is_clear);
    pass_parts(file, *parts);
    pass_reals(file, *reals);
    if (has_winding) {
        auto winding = std::make_shared<MeshWinding>();
        pass_winding(file, *winding);
        structure.winding = std::move(winding);
    }
    file.finish();
    require_mesh_memory(spec.path, mesh->file_triangles);
    if (has_clearance)
        structure.clearance = std::make_shared<const Clearance>(is_clear);
    structure.parts = std::move(parts);
    structure.reals = std::move(reals);
    return mesh;
}

void write(const std::filesystem::path& path, const std::string& identity, const SceneMesh& mesh) {
    const MeshStructure& structure = mesh.structure;
    Writer file(path);
    file(identity, mesh.sha256, mesh.format, mesh.file_triangles, mesh.inside, mesh.changes);
    pass_findings(file, mesh.findings);
    pass_mesh(file, mesh.mesh);
    const bool has_winding = structure.winding != nullptr, has_clearance = structure.clearance != nullptr;
    file(structure.centre, structure.scale, structure.solid, has_winding, has_clearance,
         has_clearance && structure.clearance->is_enough());
    pass_parts(file, *structure.parts);
    pass_reals(file, *structure.reals);
    if (has_winding)
        pass_winding(file, *structure.winding);
    file.publish();
}

std::atomic<std::uint64_t> written = 0; // bytes, since keep_meshes_in()

// Whether a mesh may be kept without harm to what the disk and this process are for.
bool has_room(const MeshStructure& mesh) {
    constexpr std::uint64_t kTriangleBytes = 300; // measured, with the winding number's tables
    const std::uint64_t bytes = kTriangleBytes * mesh.triangles();
    return std::filesystem::space(folder()).available > kLeastFree + 4 * bytes && (written += bytes) <= kMostWritten;
}

} // namespace

void keep_meshes_in(const std::filesystem::path& path) {
    folder() = path;
    written = 0;
}

bool may_be_kept(const std::filesystem::path& file) {
    std::error_code error;
    const std::uintmax_t bytes = folder().empty() ? 0 : std::filesystem::file_size(file, error);
    return !error && bytes >= kLeastBytes;
}

std::shared_ptr<const SceneMesh> kept_mesh(const MeshSpec& spec, const std::string& sha256) {
    const std::string identity = identity_of(spec, sha256);
    const std::filesystem::path path = kept_path(folder(), kKind, identity);
    std::error_code error;
    if (path.empty() || !std::filesystem::is_regular_file(path, error))
        return nullptr;
    try {
        auto mesh = read(path, spec, identity);
        std::filesystem::last_write_time(path, std::filesystem::file_time_type::clock::now(), error); // used now
        return mesh;
    } catch (const UsageError&) { // of the memory
        throw;
    } catch (const std::exception& damage) {
        log_line(fmt::format("{}; the mesh is prepared anew", damage.what()));
        return nullptr;
    }
}

void keep_mesh(const MeshSpec& spec, const SceneMesh& mesh) noexcept {
    try {
        const std::string identity = identity_of(spec, mesh.sha256);
        const std::filesystem::path path = kept_path(folder(), kKind, identity);
        if (path.empty() || mesh.structure.triangles() < kLeastTriangles)
            return;
        std::filesystem::create_directories(folder());
        clear_stale_temporaries(folder());
        if (!has_room(mesh.structure))
            return;
        write(path, identity, mesh);
        limit_kept(folder(), kKind, kMostKept);
    } catch (const std::exception& error) {
        log_line(fmt::format("the prepared mesh is not kept: {}", error.what()));
    }
}

} // namespace forceshade
