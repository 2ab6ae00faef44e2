#include "host/study/energy/loop_paths.h"

#include <cmath>
#include <limits>
#include <thread>

#include "host/reference/god_object.h"
#include "host/reference/paths.h"

namespace forceshade::study {
namespace {

constexpr int kUpright = 16; /* a vertical leg has so many times fewer steps */

/// Loops as recorded paths.
template <typename T> class LoopSource final : public layout::PathSource<T> {
public:
    LoopSource(const PreparedCase& prepared, const std::vector<LoopPlaces>& loops)
        : tables_(make_tables<T>(prepared.one.scene, prepared.images, Extent::what_varies)), law_(tables_.law()),
          loops_(loops) {}

    layout::PathInput<T> input() {
        layout::PathInput<T> input;
        input.law = law_;
        input.features.motion = layout::kMotionRecorded;
        input.paths = loops_.size();
        input.steps = loops_.front().size();
        input.source = this;
        return input;
    }

    layout::PathBatch<T> batch(std::size_t first, std::size_t count) override {
        first_ = first;
        count_ = count;
        layout::PathBatch<T> batch;
        batch.first = first;
        batch.count = count;
        proxies_.clear();
        if (law_.features.surface == layout::kSurfaceMesh)
            for (std::size_t path = first; path < first + count; ++path)
                proxies_.push_back(
                    reference::proxy_start(law_, around_, reference::to_mesh_frame(law_.mesh.params, place(0, path))));
        batch.proxies = proxies_;
        return batch;
    }

    std::span<const T> positions(std::size_t step, std::size_t steps) override {
        window_.clear();
        for (std::size_t s = step; s < step + steps; ++s)
            for (std::size_t path = first_; path < first_ + count_; ++path) {
                const reference::Vector<T> at = place(s, path);
                window_.insert(window_.end(), {at.x, at.y, at.z});
            }
        return window_;
    }

private:
    reference::Vector<T> place(std::size_t step, std::size_t path) const {
        const LoopPlaces& loop = loops_[path];
        return reference::Vector<T>(loop[std::min(step, loop.size() - 1)]);
    }

    FieldTables<T> tables_;
    layout::Law<T> law_; // points into the tables
    const std::vector<LoopPlaces>& loops_;
    reference::Neighbourhood<T> around_;
    std::vector<layout::ProxyStart<T>> proxies_;
    std::vector<T> window_;
    std::size_t first_ = 0, count_ = 0;
};

/// explore(input, take, take_metrics)
template <typename T, typename Explore>
std::vector<PathWork> explored(const PreparedCase& prepared, const std::vector<LoopPlaces>& loops,
                               const Explore& explore) {
    LoopSource<T> source(prepared, loops);
    std::vector<PathWork> result(loops.size());
    const reference::TakeMetrics<T> take_metrics = [&](std::size_t first,
                                                       std::span<const layout::PathMetrics<T>> metrics) {
        for (std::size_t i = 0; i < metrics.size(); ++i)
            result[first + i] = {{static_cast<double>(metrics[i].work) - static_cast<double>(metrics[i].work_rest),
                                  static_cast<double>(metrics[i].effort) - static_cast<double>(metrics[i].effort_rest)},
                                 metrics[i].unfinished};
    };
    explore(source.input(), reference::TakePaths<T>([](const layout::PathChunk<T>&) {}), take_metrics);
    return result;
}

} // namespace

LoopPlaces loop_places(const Section& section, double out, double back, int steps) {
    const double first = section.breaks.front(), last = section.breaks.back();
    LoopPlaces places;
    std::vector<double> across;
    std::size_t next = 1;
    for (int i = 0; i <= steps; ++i) {
        const double x = i == steps ? last : first + (last - first) * i / steps;
        for (; next + 1 < section.breaks.size() && section.breaks[next] <= x; ++next) {
            across.push_back(std::nextafter(section.breaks[next], first));
            across.push_back(section.breaks[next]);
        }
        across.push_back(x);
    }
    for (const double x : across)
        places.push_back(section.below(x, out));
    const int upright = std::max(1, steps / kUpright);
    for (int i = 1; i <= upright; ++i)
        places.push_back(section.below(last, std::lerp(out, back, static_cast<double>(i) / upright)));
    for (std::size_t i = across.size() - 1; i-- > 0;)
        places.push_back(section.below(across[i], back));
    for (int i = 1; i <= upright; ++i)
        places.push_back(section.below(first, std::lerp(back, out, static_cast<double>(i) / upright)));
    return places;
}

std::vector<PathWork> engine_work(Engine& engine, const PreparedCase& prepared, const std::vector<LoopPlaces>& loops) {
    const auto explore = [&](const auto& input, const auto& take, const auto& metrics) {
        engine.explore(input, take, metrics);
    };
    return engine.report().f64 ? explored<double>(prepared, loops, explore) : explored<float>(prepared, loops, explore);
}

std::vector<PathWork> oracle_work(const PreparedCase& prepared, const std::vector<LoopPlaces>& loops) {
    return explored<double>(prepared, loops, [&](const auto& input, const auto& take, const auto& metrics) {
        reference::evaluate_paths<double>(input, {}, take, metrics);
    });
}

} // namespace forceshade::study
