// Strokes a scene's surface as a haptic loop would, and prints what it feels: feel SCENE.toml
#include <cstdio>

#include <forceshade.hpp>

int main(int argc, char** argv) try {
    const forceshade::Scene scene(argc > 1 ? argv[1] : "scene.toml");
    std::fprintf(stderr, "%s\n", scene.warnings());
    forceshade::Probe probe(scene);
    std::puts("path,t,x,y,z,fx,fy,fz,field_fz");
    for (int i = 0; i < 100; ++i) {
        const double t = i * 1e-3, x = -0.01 + 0.2 * t, z = -0.0005;
        const auto touch = probe.step({x, 0, z}), field = scene.at({x, 0, z});
        std::printf("0,%.17g,%.17g,0,%.17g,%.17g,%.17g,%.17g,%.17g\n", t, x, z, touch.force[0], touch.force[1],
                    touch.force[2], field.force[2]);
    }
} catch (const forceshade::Error& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 2;
}
