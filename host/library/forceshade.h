/* The force laws for programs of one's own, in C: link forceshade::forceshade (find_package or add_subdirectory).
   Numbers are those of `forceshade field` and `forceshade explore`, digit for digit.

   Units are m, N, N/m, kg and s. Places and vectors are x, y, z. No argument may be NULL unless that is said. What
   fs_..._from_..., fs_scene_copy and fs_probe_new return belongs to the caller, who frees it; copies, probes and their
   scene may be freed in any order. Functions that fail return NULL or an fs_error and tell more by fs_last_error().
   Nothing throws. C99; C++ has forceshade.hpp. */
#ifndef FORCESHADE_H
#define FORCESHADE_H

#include <stddef.h>
#include <stdint.h>

#define FORCESHADE_VERSION_MAJOR 0
#define FORCESHADE_VERSION_MINOR 1
#define FORCESHADE_VERSION_PATCH 0

#define FORCESHADE_API __attribute__((visibility("default")))

#ifdef __cplusplus
extern "C" {
#endif

/* major * 10000 + minor * 100 + patch of the library that runs; the macros are those of the header. */
FORCESHADE_API int fs_version(void);

/* Errors */

typedef enum fs_error {
    FS_OK = 0,
    FS_FAILED = 1,   /* anything else, such as no memory */
    FS_ARGUMENT = 2, /* of a function */
    FS_SCENE = 3,    /* a scene or a mesh in which something is wrong */
    FS_FILE = 4      /* missing, unreadable or damaged */
} fs_error;

/* What this thread's last failure was, and in the command line's words. FS_OK and "" before the first; a success
   changes nothing. The text lives until the thread's next failure. */
FORCESHADE_API fs_error fs_last_error_code(void);
FORCESHADE_API const char* fs_last_error(void);

/* Scenes: a surface and its force law */

/* Its tables never change, so threads may share a scene; its pose may change (fs_scene_pose). */
typedef struct fs_scene fs_scene;

/* As force.shading of a scene; barycentric is for triangles alone. */
typedef enum fs_shading {
    FS_SHADING_NONE,
    FS_SHADING_MORGENBESSER,
    FS_SHADING_BARYCENTRIC,
    FS_SHADING_MEAN_VALUE,
    FS_SHADING_TWO_PASS /* its force grows by 1/cos of the angle that it is turned by, without a bound */
} fs_shading;

typedef enum fs_precision { FS_F32, FS_F64 } fs_precision;

/* How facets are wound: as given, or each turned to face outward. */
typedef enum fs_orientation { FS_ORIENT_AS_GIVEN, FS_ORIENT_OUTWARD } fs_orientation;

/* The law on a mesh. */
typedef struct fs_law {
    double stiffness; /* N/m */
    fs_shading shading;
    fs_precision precision;
    double weld; /* m: vertices no further apart are one */
    fs_orientation orientation;
} fs_law;

/* A scene's own defaults: 1000 N/m, no shading, single precision, no weld, facets as given. */
FORCESHADE_API fs_law fs_default_law(void);

/* The scene in a TOML file. `overrides`: NULL, or lines that replace keys, "surface.radius = 700 mil\n...".
   FS_SCENE, FS_FILE. */
FORCESHADE_API fs_scene* fs_scene_from_file(const char* file, const char* overrides);

/* The same from TOML text; files that it names are relative to `folder`, NULL: the current one. */
FORCESHADE_API fs_scene* fs_scene_from_toml(const char* text, const char* folder, const char* overrides);

/* A polygon mesh from arrays, which are copied: vertices are vertex_count * 3 numbers, m. The first corner_counts[0] of
   `corners`, numbers of vertices from 0 on, counterclockwise seen from outside, are the first facet, and so on; NULL:
   all are triangles. `law`: NULL is fs_default_law(). FS_ARGUMENT, FS_SCENE. */
FORCESHADE_API fs_scene* fs_scene_from_mesh(const double* vertices, size_t vertex_count, const int* corners,
                                            const int* corner_counts, size_t facets, const fs_law* law);

/* The same with the law of a TOML text whose surface.kind is "mesh"; vertices are in its surface.unit. */
FORCESHADE_API fs_scene* fs_scene_from_toml_and_mesh(const char* text, const char* overrides, const double* vertices,
                                                     size_t vertex_count, const int* corners, const int* corner_counts,
                                                     size_t facets);

/* Another handle to the same tables, with a pose of its own, which begins as this one's. Takes no time. */
FORCESHADE_API fs_scene* fs_scene_copy(const fs_scene* scene);

/* NULL does nothing. */
FORCESHADE_API void fs_scene_free(fs_scene* scene);

/* The scene as complete TOML; lives as long as the scene. */
FORCESHADE_API const char* fs_scene_toml(const fs_scene* scene);

/* Warnings about the scene or its mesh, a line each; "" without any. Lives as long as the scene. */
FORCESHADE_API const char* fs_scene_warnings(const fs_scene* scene);

/* Where the object is: world = rotation * object + translation, m, rotation by rows and orthonormal to 1e-6; NULL: not
   rotated, not moved. Places, forces and proxies are the world's from now on, of the scene's probes too; their history
   moves with the object. No other thread may use the scene or its probes meanwhile. Neither allocates nor locks;
   FS_ARGUMENT leaves the pose as it was. */
FORCESHADE_API fs_error fs_scene_pose(fs_scene* scene, const double rotation[9], const double translation[3]);

/* Forces */

typedef enum fs_status {
    FS_FREE,
    FS_TOUCHING,
    FS_UNFINISHED,   /* touching, and the proxy did not come to rest: no force is larger for it */
    FS_OUT_OF_RANGE, /* no answer: too far from the scene for the precision */
    FS_NOT_A_NUMBER  /* no answer: a coordinate is NaN or infinite */
} fs_status;

/* What a probe meets, computed in the scene's precision. */
typedef struct fs_touch {
    double force[3]; /* N; 0 out of contact */
    double proxy[3]; /* m, in the world: where the surface is touched; out of contact the probe */
    double depth;    /* m; 0 out of contact */
    int facet;       /* its number; -1 out of contact */
    fs_status status;
} fs_touch;

/* What a probe at a place, m, meets that has no history. Any thread; neither allocates nor locks. */
FORCESHADE_API fs_touch fs_scene_at(const fs_scene* scene, const double place[3]);

/* The same for `count` places, 3 * count numbers, into `count` touches, on `threads` threads; 0: as many as there are
   cores. On 1 it neither allocates nor locks. The touches do not depend on the threads. */
FORCESHADE_API fs_error fs_scene_at_many(const fs_scene* scene, const double* places, size_t count, fs_touch* touches,
                                         unsigned threads);

/* Probes with a history, as a haptic loop has them */

/* On a mesh its proxy (the god-object) stays on the side where it began. For one thread at a time; each of several
   threads has its own. */
typedef struct fs_probe fs_probe;

/* A scene's first probe takes a while (on a mesh several updates a triangle), further ones do not. Any thread.
   FS_FAILED. */
FORCESHADE_API fs_probe* fs_probe_new(const fs_scene* scene);

/* NULL does nothing. */
FORCESHADE_API void fs_probe_free(fs_probe* probe);

/* What it meets at its next place, m, in the world. Without an answer the path ends, and the next place begins another.
   Neither allocates nor locks. */
FORCESHADE_API fs_touch fs_probe_step(fs_probe* probe, const double place[3]);

/* Forgets the past: the next place begins a path. Neither allocates nor locks. */
FORCESHADE_API void fs_probe_reset(fs_probe* probe);

/* A probe's history as plain numbers, for a rewind or another process with the same scene and version. */
typedef struct fs_probe_state {
    uint64_t scene;        /* a digest of the scene: to no other does the state belong */
    double proxy[3];       /* in the mesh's own frame, which moves with the object */
    uint32_t triangles[3]; /* that hold the proxy, `count` of them */
    uint32_t count;
    uint32_t begun;    /* 1: a path has begun; 0: the next place begins one */
    uint32_t cornered; /* 1: held by edges or corners */
} fs_probe_state;

/* Neither allocates nor locks. */
FORCESHADE_API fs_probe_state fs_probe_get_state(const fs_probe* probe);

/* Goes on from that state as the probe did that it was taken from, digit for digit. FS_ARGUMENT for one of another
   scene or one that no probe has, which changes nothing. Neither allocates nor locks. */
FORCESHADE_API fs_error fs_probe_set_state(fs_probe* probe, const fs_probe_state* state);

/* Stability */

/* The stiffness, N/m, up to which a mass, kg, with a viscous damping, N s/m, comes to rest at a sampled wall: the force
   is held for sample_time, s, and acts delay_samples samples late. NaN for values that are not positive (the delay may
   be 0) or beyond 1e6 samples. Any thread; neither allocates nor locks. */
FORCESHADE_API double fs_critical_stiffness(double mass, double damping, double sample_time, unsigned delay_samples);

#ifdef __cplusplus
}
#endif

#endif
