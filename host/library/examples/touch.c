/* The library in C: a tetrahedron from arrays, many places at once, a probe that is taken back, an error. */
#include <stdio.h>
#include <string.h>

#include <forceshade.h>

static void print(const char* what, fs_touch touch) {
    static const char* const names[] = {"free", "touching", "unfinished", "out of range", "not a number"};
    printf("%s: %s, %.9g %.9g %.9g N, facet %d\n", what, names[touch.status], touch.force[0], touch.force[1],
           touch.force[2], touch.facet);
}

int main(void) {
    const double vertices[] = {0, 0, 0, 0.02, 0, 0, 0, 0.02, 0, 0, 0, 0.02}; /* m */
    const int corners[] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    const double places[] = {0.03, 0, 0, 0.006, 0.006, 0.007, 1e300, 0, 0}; /* m */
    const double above[] = {0.008, 0.008, 0.008}, below[] = {0.005, 0.005, 0.005}, deeper[] = {0.001, 0.001, 0.001};
    fs_touch touches[3], first, again;
    fs_probe_state state;
    fs_law law = fs_default_law();
    fs_scene* scene;
    fs_probe* probe;
    int i;

    if (fs_version() / 100 != FORCESHADE_VERSION_MAJOR * 100 + FORCESHADE_VERSION_MINOR)
        return 1;
    law.stiffness = 500; /* N/m */
    law.precision = FS_F64;
    scene = fs_scene_from_mesh(vertices, 4, corners, NULL, 4, &law);
    if (!scene) {
        fprintf(stderr, "%s\n", fs_last_error());
        return 1;
    }
    fs_scene_at_many(scene, places, 3, touches, 1);
    for (i = 0; i < 3; ++i)
        print("place", touches[i]);

    probe = fs_probe_new(scene);
    fs_probe_step(probe, above);
    print("probe", fs_probe_step(probe, below));
    state = fs_probe_get_state(probe);
    first = fs_probe_step(probe, deeper);
    if (fs_probe_set_state(probe, &state) != FS_OK)
        return 1;
    again = fs_probe_step(probe, deeper);
    print("again", again);
    fs_probe_free(probe);
    fs_scene_free(scene);

    law.stiffness = -1;
    if (fs_scene_from_mesh(vertices, 4, corners, NULL, 4, &law))
        return 1;
    printf("error %d: %s\n", fs_last_error_code(), fs_last_error());
    return memcmp(&first, &again, sizeof first) != 0;
}
