// A haptic loop as CHAI3D and H3D have it: a hand that rests on a cube that turns and rises, 1000 times a second.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <thread>

#include <forceshade.hpp>

int main() try {
    constexpr double kHalf = 0.01; // m
    forceshade::Mesh cube;
    for (int i = 0; i < 8; ++i)
        cube.vertices.push_back({i & 1 ? kHalf : -kHalf, i & 2 ? kHalf : -kHalf, i & 4 ? kHalf : -kHalf});
    cube.corners = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
    cube.corner_counts = {4, 4, 4, 4, 4, 4};

    forceshade::Law law;
    law.stiffness = forceshade::critical_stiffness(0.1, 1, 1e-3) / 2; // of the device: kg, N s/m, s
    law.shading = FS_SHADING_MEAN_VALUE;
    law.precision = FS_F64;
    forceshade::Scene scene(cube, law);
    forceshade::Probe tool(scene);

    auto next = std::chrono::steady_clock::now();
    for (int tick = 0; tick < 300; ++tick) {
        const double t = 1e-3 * tick, turn = 2 * t, c = std::cos(turn), s = std::sin(turn);
        scene.pose({c, -s, 0, s, c, 0, 0, 0, 1}, {0.1, 0, 0.02 * t}); // where the object is now
        const forceshade::Vector hand{0.103, 0.002, 0.012};           // the device's position
        const forceshade::Touch touch = tool.step(hand);              // the force for the device
        if (tick % 25 == 0)
            std::printf("%.3f s: %.6f %.6f %.6f N, facet %d\n", t, touch.force[0], touch.force[1], touch.force[2],
                        touch.facet);
        std::this_thread::sleep_until(next += std::chrono::milliseconds(1));
    }
} catch (const forceshade::Error& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 1;
}
