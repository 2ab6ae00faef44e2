#include "host/renderer/renderer_engine.h"

#include <algorithm>
#include <exception>
#include <optional>

#include <fmt/format.h>

#include "host/clock.h"
#include "host/field/case_law.h"
#include "host/mesh/structure.h"
#include "host/norm.h"
#include "host/program.h"
#include "host/reference/path_step.h"

namespace forceshade {
namespace {

constexpr std::size_t kVoxels = std::size_t(1) << 18; // of a chunk
constexpr std::size_t kSteps = 4096;                  // the same of a path

class RendererEngine final : public Engine {
public:
    RendererEngine(const RendererSource& source, const PreparedCase& prepared, const RendererPatience& patience)
        : name_(source.name), prepared_(prepared), origin_(scene_origin(prepared)),
          renderer_(source, prepared, prepared.one.scene.paths ? 1 / prepared.one.scene.paths->rate : 0, patience) {}

    EngineReport report() const override { return {"renderer", name_, "", "", false, true}; }

    EngineTimes run(const EngineWork& work) override {
        seconds_ = 0;
        voxels_ = 0;
        try {
            std::visit(
                [&]<typename Work>(const Work& one) {
                    if constexpr (requires { one.take_metrics; })
                        explore(one);
                    else
                        evaluate(one);
                },
                work);
        } catch (const RendererError& error) {
            throw RendererError(fmt::format("{} {}", name_, error.what()), error.update);
        }
        EngineTimes times;
        times.kernel = seconds_;
        times.voxels_evaluated = voxels_;
        return times;
    }

private:
    template <typename T>
    reference::Contact<T> contact_of(const RendererAnswer& answer, const reference::Vector<T>& probe,
                                     const glm::dvec3& origin) {
        seconds_ += answer.seconds;
        const double size = reference::length(answer.force), depth = size / prepared_.one.scene.force.stiffness;
        reference::Contact<T> contact{};
        contact.force = contact.unshaded = reference::Vector<T>(answer.force);
        contact.depth = T(depth);
        contact.facet = size > 0 ? 0 : layout::kNoFacet;
        contact.proxy = probe;
        if (answer.has_proxy)
            contact.proxy = reference::Vector<T>(answer.proxy - origin);
        else if (size > 0)
            contact.proxy += reference::Vector<T>(depth / size * answer.force);
        return contact;
    }

    template <typename T> void evaluate(const FieldWork<T>& work) {
        const layout::FieldInput<T>& input = work.input;
        const MeshStructure* const mesh = prepared_.images.mesh ? &prepared_.images.mesh->structure : nullptr;
        const glm::dvec3 centre = mesh ? mesh->centre : glm::dvec3(0); // of the places in a field's tables
        const double scale = mesh ? mesh->scale : 1;
        const std::size_t row = input.x.size(), layer = row * input.y.size();
        const std::size_t layers = std::max<std::size_t>(1, kVoxels / layer);
        reference::SampleBuffers<T> samples;
        std::vector<glm::dvec3> probes;
        for (std::size_t z = 0; z < input.z.size(); z += layers) {
            layout::FieldChunk<T> chunk{};
            chunk.x_count = chunk.x_pitch = row;
            chunk.y_count = input.y.size();
            chunk.z_first = z;
            chunk.z_count = std::min(layers, input.z.size() - z);
            std::vector<reference::Vector<T>> places;
            for (std::size_t k = z; k < z + chunk.z_count; ++k)
                for (const T y : input.y)
                    for (const T x : input.x)
                        places.push_back({x, y, input.z[k]});
            probes.clear();
            for (const reference::Vector<T>& place : places)
                probes.push_back(centre + scale * glm::dvec3(place));
            samples.resize(input.law.features.channels, places.size());
            const std::vector<RendererAnswer> answers = renderer_.update(probes, {.each_begins = true});
            for (std::size_t i = 0; i < places.size(); ++i) {
                const reference::Contact<T> contact =
                    contact_of(answers[i], reference::Vector<T>(probes[i] - origin_), origin_);
                samples.store(i, contact, contact.force);
                reference::SampleBuffers<T>::put(samples.unshaded, i, contact.unshaded);
            }
            samples.set_spans(chunk);
            chunk.unshaded = samples.unshaded;
            voxels_ += places.size();
            work.take(chunk);
        }
    }

    // One path after the other: a renderer has one history at a time.
    template <typename T> void explore(const PathWork<T>& work) {
        const layout::PathInput<T>& input = work.input;
        if (input.surface)
            throw UsageError("a renderer gives the whole force: leave [friction] and texture.vibration out, or "
                             "--renderer");
        for (std::size_t path = 0; path < input.paths; ++path) {
            const layout::PathBatch<T> batch = input.source->batch(path, 1);
            const layout::PathMetrics<T> metrics = walk(input, batch, work.take);
            work.take_metrics(path, std::span(&metrics, 1));
        }
    }

    template <typename T>
    layout::PathMetrics<T> walk(const layout::PathInput<T>& input, const layout::PathBatch<T>& batch,
                                const reference::TakePaths<T>& take) {
        const bool closed = input.features.loop == layout::kLoopClosed;
        reference::BatchPath<T> moved{input, batch, 0};
        const std::size_t steps = moved.steps(), longest = batch.longest ? batch.longest : input.steps;
        const layout::HandParams<T> hand = moved.hand();
        const layout::MotionParams<T> motion = moved.motion();
        layout::PathState<T> state{};
        renderer_.begin_path();
        reference::SampleBuffers<T> samples;
        for (std::size_t first = 0; first < longest; first += kSteps) {
            check_interrupt();
            layout::PathChunk<T> chunk{};
            chunk.path_first = batch.first;
            chunk.path_count = chunk.pitch = 1;
            chunk.step_first = first;
            chunk.step_count = std::min(kSteps, longest - first);
            if (moved.recorded())
                moved.follow(input.source->positions(first, std::min(chunk.step_count + 1, longest - first)), first);
            samples.resize(input.features.channels, chunk.step_count);
            const std::size_t end = std::min(first + chunk.step_count, steps);
            std::vector<RendererAnswer> ahead; // open loop: where the probe will be is known
            if (!closed && first < end) {
                std::vector<glm::dvec3> probes;
                for (std::size_t step = first; step < end; ++step)
                    probes.push_back(world_place(glm::dvec3(moved.at(step)), origin_));
                ahead = renderer_.update(probes);
            }
            if (first == 0)
                state = reference::begin_state(input.features, hand, moved.at(0));
            for (std::size_t step = first; step < end; ++step) {
                const reference::Vector<T> here = moved.at(step), next = moved.after(step, here);
                std::exception_ptr failed;
                const auto force = [&](const reference::Vector<T>& probe) noexcept {
                    try {
                        const RendererAnswer answer =
                            closed ? renderer_.update(world_place(glm::dvec3(probe), origin_)) : ahead[step - first];
                        if (!is_force(answer.force)) { // a hand would fall through it
                            const glm::dvec3 at = world_place(glm::dvec3(probe), origin_);
                            throw RendererError(
                                fmt::format("gave a force that is not finite in step {}, at ({:.6g}, {:.6g}, {:.6g}) m",
                                            step, at.x, at.y, at.z),
                                {});
                        }
                        return reference::LawContact<T>{contact_of(answer, probe, origin_)};
                    } catch (...) {
                        failed = std::current_exception();
                        return reference::LawContact<T>{};
                    }
                };
                const reference::PathSampled<T> sampled = reference::take_step(input, hand, motion, state, here, next,
                                                                               static_cast<layout::uint>(steps), force);
                if (failed)
                    std::rethrow_exception(failed);
                samples.store(step - first, sampled.contact, sampled.force);
                reference::SampleBuffers<T>::put(samples.position, step - first, sampled.position);
            }
            chunk.position = samples.position;
            samples.set_spans(chunk);
            take(chunk);
        }
        return state.metrics;
    }

    std::string name_;
    const PreparedCase& prepared_;
    glm::dvec3 origin_; /* m: from which places of paths are measured */
    RendererProcess renderer_;
    double seconds_ = 0; /* s: in the renderer */
    std::uint64_t voxels_ = 0;
};

} // namespace

std::unique_ptr<Engine> make_renderer_engine(const RendererSource& source, const PreparedCase& prepared,
                                             const RendererPatience& patience) {
    return std::make_unique<RendererEngine>(source, prepared, patience);
}

} // namespace forceshade
