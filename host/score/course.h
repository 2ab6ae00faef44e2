// The standard course: scenes, strokes and the oracle's forces on them, frozen by a version, so that a renderer's score
// on it can be cited and compared.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>

namespace forceshade::score {

inline constexpr int kCourseVersion = 1;
/// SHA-256 of the file SHA256SUMS of this version, and by it of every scene, mesh, stroke and force.
inline constexpr std::string_view kCourseDigest = "2acc414c7da2599b60bbc3cb402f38d11caa2ba02533b2ee7a6bdb429ff9296c";

inline constexpr std::uint64_t kCourseScanSeed = 2026; /* of the scan's vertices */
inline constexpr std::uint64_t kCourseHandSeed = 1996; /* of hand-like strokes, plus their number */

// Shapes: what the probe strokes.

struct SurfacePoint {
    glm::dvec3 place;  /* mm */
    glm::dvec3 normal; /* 1: the direction in which strokes are lifted off the surface */
};

/// A shape, and the nominal surface on which its strokes lie.
struct CourseShape {
    const char* name;  /* of its files */
    const char* about; /* for a reader, one phrase */
    const char* keys;  /* TOML of the scene behind its [surface] */
    std::string mesh;  /* OBJ in mm: closed, counterclockwise seen from outside; empty: an analytic surface */
    std::function<SurfacePoint(double u, double v)> surface; /* at u and v, mm, along the surface from its middle */
    double span;                                             /* mm: length of its longest stroke */
    double pressing = 1;                                     /* 1: its depths over those of most shapes */
};

/// The twelve shapes, made anew by formulas and, of the scan, random numbers of a fixed seed.
std::vector<CourseShape> course_shapes();

// Strokes.

inline constexpr std::size_t kCourseStrokes = 12;   /* a scene */
inline constexpr std::size_t kCourseSamples = 1000; /* a stroke, 1 ms apart */

/// The strokes on a shape: CSV with the columns path, t, x, y, z; s and m, rounded to 1 nm.
std::string course_strokes(const CourseShape& shape);

/// With that many decimals; no negative zero.
std::string fixed_decimals(double value, int decimals);

// The course.

struct CourseScene {
    std::string name;
    std::string toml;    /* the scene */
    std::string mesh;    /* OBJ; empty: it has none */
    std::string strokes; /* CSV */
};

std::vector<CourseScene> course();

/// The files that write_course() writes.
std::vector<std::filesystem::path> course_files(const std::filesystem::path& folder);

struct CourseWritten {
    std::size_t files = 0;
    std::string digest; /* SHA-256 of SHA256SUMS */

    /// Whether scores on these files are scores of kCourseVersion.
    bool standard() const { return digest == kCourseDigest; }
};

/// Writes scenes, meshes, strokes, the oracle's forces, README.md and SHA256SUMS. Replaces files that are there.
/// \throws IoError, Interrupted.
CourseWritten write_course(const std::filesystem::path& folder);

} // namespace forceshade::score
