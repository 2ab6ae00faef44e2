// Forces over a grid, by the engine's kernel and by the CPU oracle on one thread.
#include <algorithm>
#include <type_traits>

#include <fmt/format.h>

#include "host/prepare/tables.h"
#include "host/reference/field.h"
#include "host/study/error_time/contender.h"
#include "host/study/error_time/half_forces.h"
#include "host/study/error_time/law_at.h"

namespace forceshade::study::error_time {
namespace {

constexpr std::size_t kMostCompared = 32768; // voxels

template <typename T> using Consume = std::function<void(const layout::FieldChunk<T>&)>;

template <typename T> struct Grid {
    FieldTables<T> tables;
    GridSpec spec;

    std::size_t voxels() const { return tables.x.size() * tables.y.size() * tables.z.size(); }
};

template <typename T> auto grid_of(const Subject& subject, const Variant& variant) {
    return lazily([prepared = variant.prepared, spec = subject.grid] {
        Scene scene = prepared->one.scene;
        scene.grid = spec;
        scene.output.channels = layout::kChannelForce;
        return Grid<T>{make_tables<T>(scene, prepared->images, Extent::everything), spec};
    });
}

// Adds what stands in a chunk, at most kMostCompared voxels evenly chosen from the grid.
template <typename T> void add_chunk(Evaluated& evaluated, const Grid<T>& grid, const layout::FieldChunk<T>& chunk) {
    const std::size_t stride = grid.voxels() / kMostCompared + 1;
    for (std::size_t z = 0; z < chunk.z_count; ++z)
        for (std::size_t y = 0; y < chunk.y_count; ++y)
            for (std::size_t x = 0; x < chunk.x_count; ++x) {
                const std::size_t place[3] = {x, chunk.y_first + y, chunk.z_first + z};
                if (((place[2] * grid.spec.size[1] + place[1]) * grid.spec.size[0] + x) % stride != 0)
                    continue;
                glm::dvec3 at(0);
                for (int i = 0; i < 3; ++i) {
                    const auto axis = static_cast<std::size_t>(i);
                    at[i] = grid.spec.origin[axis] + grid.spec.spacing[axis] * static_cast<double>(place[axis]);
                }
                evaluated.at.push_back(at);
                evaluated.force.emplace_back(
                    reference::vector_at(chunk.force, (z * chunk.y_count + y) * chunk.x_pitch + x));
            }
}

// Evaluates a grid; receives its chunks.
template <typename T> using Evaluate = std::function<EngineTimes(const layout::FieldInput<T>&, const Consume<T>&)>;

// Seconds of a voxel: those of a grid over all its voxels, evaluated or left out by a plan. A small grid is over in a
// millisecond, of which one says little: the median of three.
template <typename Measure> double per_voxel(std::size_t voxels, const Measure& measure) {
    constexpr double kLongEnough = 5e-3; // s
    double seconds[3] = {measure(), 0, 0};
    if (seconds[0] * static_cast<double>(voxels) > kLongEnough)
        return seconds[0];
    seconds[1] = measure();
    seconds[2] = measure();
    std::sort(std::begin(seconds), std::end(seconds));
    return seconds[1];
}

template <typename T>
Contender grid_contender(const Subject& subject, const Variant& variant, const std::string& family,
                         const Evaluate<T>& evaluate) {
    Contender contender = contender_of(subject, variant, family, kPrecision<T>);
    const auto grid = grid_of<T>(subject, variant);
    contender.evaluate = [grid, evaluate] {
        Evaluated evaluated;
        evaluate(grid().tables.input(),
                 [&](const layout::FieldChunk<T>& chunk) { add_chunk(evaluated, grid(), chunk); });
        return evaluated;
    };
    contender.exact = [prepared = variant.prepared](const std::vector<glm::dvec3>& at) {
        return direct_forces<double>(*prepared, at);
    };
    contender.seconds = [grid, evaluate] {
        return per_voxel(grid().voxels(), [&] {
            const EngineTimes times = evaluate(grid().tables.input(), [](const layout::FieldChunk<T>&) {});
            return (times.kernel + times.plan) / static_cast<double>(grid().voxels());
        });
    };
    return contender;
}

// A kernel in f32 whose results are rounded as a file of halves has them; the rounding is timed with it.
Contender half_grid(const Subject& subject, const Variant& variant, const std::string& family,
                    const Evaluate<float>& evaluate) {
    Contender contender = grid_contender<float>(subject, variant, family, evaluate);
    contender.precision = "f32, half output";
    contender.name = contender_name(subject, variant, family + " f32, half output");
    contender.evaluate = [whole = contender.evaluate] {
        Evaluated evaluated = whole();
        std::vector<float> numbers;
        for (const glm::dvec3& force : evaluated.force)
            numbers.insert(numbers.end(), {float(force.x), float(force.y), float(force.z)});
        std::vector<Half> halves;
        to_halves(numbers, halves);
        evaluated.force = vectors_of<Half>(halves);
        return evaluated;
    };
    contender.seconds = [grid = grid_of<float>(subject, variant), evaluate, halves = std::vector<Half>()]() mutable {
        using Clock = std::chrono::steady_clock;
        return per_voxel(grid().voxels(), [&] {
            double rounding = 0;
            const EngineTimes times = evaluate(grid().tables.input(), [&](const layout::FieldChunk<float>& chunk) {
                const Clock::time_point start = Clock::now();
                to_halves(chunk.force, halves);
                rounding += std::chrono::duration<double>(Clock::now() - start).count();
            });
            return (times.kernel + times.plan + rounding) / static_cast<double>(grid().voxels());
        });
    };
    return contender;
}

template <typename T> Evaluate<T> on_engine(Engine& engine) {
    return [&engine](const layout::FieldInput<T>& input, const Consume<T>& consume) {
        return engine.evaluate(input, consume);
    };
}

// The oracle over the whole grid on one thread; of a mesh every voxel is evaluated.
template <typename T> Evaluate<T> on_one_thread() {
    return [](const layout::FieldInput<T>& input, const Consume<T>& consume) {
        reference::FieldOptions options;
        options.threads = 1;
        using Clock = std::chrono::steady_clock;
        EngineTimes times;
        Clock::time_point start = Clock::now();
        reference::evaluate_field<T>(input, options, [&](const layout::FieldChunk<T>& chunk) {
            times.kernel += std::chrono::duration<double>(Clock::now() - start).count();
            consume(chunk);
            start = Clock::now();
        });
        return times;
    };
}

} // namespace

void add_grids(Contenders& contenders, const Subject& subject, const Variant& variant, Engine& engine) {
    const EngineReport report = engine.report();
    const std::string family = report.engine == "gpu" ? "field, kernel" : "field, CPU on all cores";
    contenders.push_back(grid_contender<float>(subject, variant, family, on_engine<float>(engine)));
    if (report.f64 && variant.thorough)
        contenders.push_back(grid_contender<double>(subject, variant, family, on_engine<double>(engine)));
    if (!variant.thorough)
        return;
    contenders.push_back(half_grid(subject, variant, family, on_engine<float>(engine)));
    const std::string alone = "field, CPU on one thread";
    contenders.push_back(grid_contender<float>(subject, variant, alone, on_one_thread<float>()));
    contenders.push_back(grid_contender<double>(subject, variant, alone, on_one_thread<double>()));
}

} // namespace forceshade::study::error_time
