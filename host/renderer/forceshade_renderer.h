/* A haptic renderer of your own, scored by forceshade. Build a shared library that exports the six functions below:

       cc -O2 -shared -fPIC -I PREFIX/include mine.c -o libmine.so
       forceshade score SCENE.toml --paths STROKES.csv --renderer ./libmine.so

   The library is loaded into a process of its own. One thread calls it, and each call is timed there. Units are m, N,
   N/m and s. A function that returns an int returns 0, or a number of your own for an error, which fsr_error explains.
   C99; C++ may include this file, too. */
#ifndef FORCESHADE_RENDERER_H
#define FORCESHADE_RENDERER_H

#include <stddef.h>

#define FSR_VERSION 1 /* of this interface */
#define FSR_API __attribute__((visibility("default")))

#ifdef __cplusplus
extern "C" {
#endif

/* What is touched. It and all that it points to stay until fsr_close. */
typedef struct fsr_scene {
    const char* surface; /* surface.kind of the scene: "mesh", "bump", "cylinder_bump", "height_map" */
    /* Its triangles: vertices are x, y, z, m; three corners a triangle, counterclockwise seen from outside. An analytic
       surface is unbounded; its triangles are those of its nominal polyhedron within `extent` of the origin. */
    const double* vertices;
    size_t vertex_count;
    const int* corners;
    size_t triangle_count;
    double extent;       /* m; of a mesh 0 */
    double stiffness;    /* N/m */
    double period;       /* s: from one update to the next; 0 where that is not known, as in a field */
    const char* toml;    /* the complete scene */
    const char* options; /* the text behind the library's name in --renderer LIBRARY:OPTIONS; "" without one */
} fsr_scene;

/* What a probe meets; all 0 before fsr_update is called. */
typedef struct fsr_touch {
    double force[3]; /* N: on the hand */
    double proxy[3]; /* m: where the surface is touched, */
    int has_proxy;   /* if this is not 0 */
} fsr_touch;

/* FSR_VERSION, as this file had it when the library was compiled. */
FSR_API int fsr_version(void);

/* Makes a renderer of the scene, which all other functions get. */
FSR_API int fsr_open(const fsr_scene* scene, void** renderer);

/* The next update begins a path, perhaps the first: the past is forgotten. */
FSR_API int fsr_reset(void* renderer);

/* The probe's next place, m, a period after the last one. */
FSR_API int fsr_update(void* renderer, const double probe[3], fsr_touch* touch);

/* What an error number means, in words; after fsr_open failed, `renderer` is what it has set, or NULL. */
FSR_API const char* fsr_error(void* renderer, int error);

FSR_API void fsr_close(void* renderer);

#ifdef __cplusplus
}
#endif

#endif
