#include "compute/mesh_path_batch.h"

#include <algorithm>
#include <cstring>

namespace forceshade::compute {
namespace {

using layout::uint;

// Invocations that share a driver's limit of loops, or more.
constexpr std::size_t kApart = 16;

struct Channel {
    uint bit;
    std::size_t width;
};
constexpr std::array<Channel, 4> kReals{{{layout::kChannelPosition, 3},
                                         {layout::kChannelForce, 3},
                                         {layout::kChannelDepth, 1},
                                         {layout::kChannelProxy, 3}}};

// The list in which a path of this phase waits.
std::size_t list_of(uint phase) {
    switch (phase) {
    case layout::kPhaseRare:
        return 1;
    case layout::kPhaseAlone:
        return 2;
    default:
        return 0;
    }
}

std::size_t reals_of(uint channels) {
    std::size_t width = 0;
    for (const Channel& channel : kReals)
        width += channels & channel.bit ? channel.width : 0;
    return width;
}

} // namespace

std::size_t MeshPathBatch::row_bytes(uint channels, std::size_t paths, std::size_t real_size, bool recorded) {
    const std::size_t reals = reals_of(channels) + (recorded ? 3 : 0);
    return paths * (reals * real_size + (channels & layout::kChannelFacet ? sizeof(uint) : 0));
}

template <typename T>
void MeshPathBatch::begin(const layout::PathBatch<T>& batch, std::size_t steps, uint channels, std::size_t rows,
                          bool recorded) {
    first_ = batch.first;
    paths_ = batch.count;
    rows_ = rows;
    channels_ = channels;
    const std::size_t words = layout::kWalkWordCount * paths_;
    reserve(words_, (words + 1 + (kApart + 2) * paths_) * sizeof(uint));
    reserve(reals_, layout::kWalkRealCount * paths_ * sizeof(T));
    reserve(states_, paths_ * sizeof(layout::PathState<T>));
    reserve(recorded_, recorded ? 3 * (rows_ + 1) * paths_ * sizeof(T) : 0);
    reserve(samples_, reals_of(channels) * rows_ * paths_ * sizeof(T));
    reserve(facets_, channels & layout::kChannelFacet ? rows_ * paths_ * sizeof(uint) : 0);
    std::memset(words_.mapped, 0, (words + 1) * sizeof(uint));
    std::memset(reals_.mapped, 0, layout::kWalkRealCount * paths_ * sizeof(T));
    std::memset(states_.mapped, 0, paths_ * sizeof(layout::PathState<T>));
    for (std::size_t path = 0; path < paths_; ++path) {
        const layout::ProxyStart<T>& start = batch.proxies[path];
        const std::array<T, 3> proxy{start.x, start.y, start.z};
        word(layout::kWalkWordSteps, path) = batch.steps.empty() ? static_cast<uint>(steps) : batch.steps[path];
        for (uint i = 0; i < 3; ++i)
            real<T>(layout::kWalkRealProxy + i, path) = proxy[i];
    }
    for (const Buffer* buffer : {&words_, &reals_, &states_})
        flush_to_device(device_, *buffer);
}

template <typename T> void MeshPathBatch::put_positions(std::span<const T> positions) {
    std::memcpy(recorded_.mapped, positions.data(), positions.size_bytes());
    flush_to_device(device_, recorded_);
}

WaitingPaths MeshPathBatch::waiting(std::uint32_t step_end) const {
    visible_to_host(device_, words_);
    WaitingPaths waiting;
    for (std::size_t path = 0; path < paths_; ++path) {
        const uint step = word(layout::kWalkWordStep, path), phase = word(layout::kWalkWordPhase, path);
        if (step >= std::min(step_end, word(layout::kWalkWordSteps, path)) || phase == layout::kPhaseHost)
            continue;
        std::vector<uint>& list = waiting[list_of(phase)];
        list.push_back(static_cast<uint>(path));
        if (phase == layout::kPhaseAlone)
            list.resize(list.size() + kApart - 1, layout::kNoPath);
    }
    return waiting;
}

template <typename T> HostUpdates<T> MeshPathBatch::host_updates() const {
    visible_to_host(device_, words_);
    visible_to_host(device_, reals_);
    HostUpdates<T> waiting;
    for (std::size_t path = 0; path < paths_; ++path) {
        if (word(layout::kWalkWordPhase, path) != layout::kPhaseHost)
            continue;
        layout::MeshUpdate<T> update{};
        for (uint i = 0; i < 3; ++i) {
            update.probe[i] = real<T>(layout::kWalkRealProbe + i, path);
            update.proxy[i] = real<T>(layout::kWalkRealProxy + i, path);
            update.triangles[i] = word(layout::kWalkWordTriangles + i, path);
        }
        update.count = word(layout::kWalkWordHeld, path) & layout::kHeldCount;
        update.cornered = (word(layout::kWalkWordHeld, path) & layout::kHeldCornered) != 0;
        waiting.paths.push_back(static_cast<uint>(path));
        waiting.updates.push_back(update);
    }
    return waiting;
}

template <typename T> void MeshPathBatch::put(const HostUpdates<T>& done) {
    for (std::size_t i = 0; i < done.paths.size(); ++i) {
        const std::size_t path = done.paths[i];
        const layout::MeshUpdate<T>& update = done.updates[i];
        for (uint axis = 0; axis < 3; ++axis) {
            real<T>(layout::kWalkRealProxy + axis, path) = update.proxy[axis];
            real<T>(layout::kWalkRealRest + axis, path) = update.rest[axis];
            word(layout::kWalkWordTriangles + axis, path) = update.triangles[axis];
        }
        word(layout::kWalkWordFelt, path) = update.triangle;
        word(layout::kWalkWordHeld, path) = update.count | (update.cornered ? layout::kHeldCornered : 0) |
                                            (update.touching ? layout::kHeldTouching : 0) |
                                            (update.back ? layout::kHeldBack : 0) |
                                            (update.finished ? 0 : layout::kHeldUnfinished);
        word(layout::kWalkWordPhase, path) = layout::kPhaseFelt;
        word(layout::kWalkWordStage, path) = layout::kStageBegin;
    }
    flush_to_device(device_, words_);
    flush_to_device(device_, reals_);
}

std::array<std::uint32_t, kMeshPathLists> MeshPathBatch::put_lists(const WaitingPaths& waiting) {
    uint* const to = reinterpret_cast<uint*>(words_.mapped) + layout::kWalkWordCount * paths_ + 1;
    std::array<std::uint32_t, kMeshPathLists> begins{};
    std::uint32_t at = 0;
    for (std::size_t i = 0; i < kMeshPathLists; ++i) {
        begins[i] = at;
        std::ranges::copy(waiting[i], to + at);
        at += static_cast<std::uint32_t>(waiting[i].size());
    }
    flush_to_device(device_, words_);
    return begins;
}

void MeshPathBatch::check_status() const {
    if (word(layout::kWalkWordCount, 0) & layout::kStatusUnfinished)
        throw DeviceError(DeviceError::Kind::unfinished,
                          "the device's driver ended a loop of the kernel before its work was done; nothing of these "
                          "paths can be trusted");
}

template <typename T> layout::PathChunk<T> MeshPathBatch::chunk(std::size_t step_first, std::size_t step_count) const {
    layout::PathChunk<T> chunk{};
    chunk.path_first = first_;
    chunk.path_count = chunk.pitch = paths_;
    chunk.step_first = step_first;
    chunk.step_count = step_count;
    const T* from = reinterpret_cast<const T*>(visible_to_host(device_, samples_));
    const std::array<std::span<const T>*, 4> spans{&chunk.position, &chunk.force, &chunk.depth, &chunk.proxy};
    for (std::size_t i = 0; i < kReals.size(); ++i) {
        if (!(channels_ & kReals[i].bit))
            continue;
        *spans[i] = {from, kReals[i].width * step_count * paths_};
        from += kReals[i].width * rows_ * paths_;
    }
    if (channels_ & layout::kChannelFacet)
        chunk.facet = {reinterpret_cast<const uint*>(visible_to_host(device_, facets_)), step_count * paths_};
    return chunk;
}

template <typename T> std::vector<layout::PathMetrics<T>> MeshPathBatch::metrics() const {
    const std::byte* const bytes = visible_to_host(device_, states_);
    std::vector<layout::PathMetrics<T>> metrics;
    metrics.reserve(paths_);
    for (std::size_t path = 0; path < paths_; ++path)
        metrics.push_back(reinterpret_cast<const layout::PathState<T>*>(bytes)[path].metrics);
    return metrics;
}

vk::Buffer MeshPathBatch::buffer(uint binding) const {
    switch (binding) {
    case layout::kMeshPathBindRecorded:
        return *recorded_.buffer;
    case layout::kMeshPathBindStates:
        return *states_.buffer;
    case layout::kMeshPathBindWalkWords:
        return *words_.buffer;
    case layout::kMeshPathBindWalkReals:
        return *reals_.buffer;
    case layout::kMeshPathBindSamples:
        return *samples_.buffer;
    default:
        return *facets_.buffer;
    }
}

template void MeshPathBatch::begin<float>(const layout::PathBatch<float>&, std::size_t, uint, std::size_t, bool);
template void MeshPathBatch::begin<double>(const layout::PathBatch<double>&, std::size_t, uint, std::size_t, bool);
template HostUpdates<float> MeshPathBatch::host_updates<float>() const;
template HostUpdates<double> MeshPathBatch::host_updates<double>() const;
template void MeshPathBatch::put<float>(const HostUpdates<float>&);
template void MeshPathBatch::put<double>(const HostUpdates<double>&);
template void MeshPathBatch::put_positions<float>(std::span<const float>);
template void MeshPathBatch::put_positions<double>(std::span<const double>);
template layout::PathChunk<float> MeshPathBatch::chunk<float>(std::size_t, std::size_t) const;
template layout::PathChunk<double> MeshPathBatch::chunk<double>(std::size_t, std::size_t) const;
template std::vector<layout::PathMetrics<float>> MeshPathBatch::metrics<float>() const;
template std::vector<layout::PathMetrics<double>> MeshPathBatch::metrics<double>() const;

} // namespace forceshade::compute
