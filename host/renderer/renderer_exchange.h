// The memory that the program and a renderer's process share.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <semaphore.h>

#include "host/renderer/forceshade_renderer.h"

namespace forceshade {

inline constexpr int kRendererDescriptor = 3;
inline constexpr std::size_t kRendererBatch = 1024; // updates at once

enum RendererRequest : std::uint32_t { kRendererUpdate, kRendererEnd };
/// Whether updates begin paths.
enum RendererBegins : std::uint32_t { kRendererGoesOn, kRendererBegins, kRendererEachBegins };

/// What the process is at when something goes wrong.
enum RendererStage : std::uint32_t {
    kRendererLoading,
    kRendererOpening,
    kRendererReady,
    kRendererUpdating,
    kRendererClosing
};

struct RendererItem {
    double probe[3];
    double seconds;
    fsr_touch touch;
};

struct RendererExchange {
    sem_t request, reply;
    std::int64_t program; // the process that asks: without it this one ends
    std::uint32_t what;   // RendererRequest
    std::uint32_t count;  // of items
    std::uint32_t begins; // RendererBegins
    std::uint32_t cold;
    std::atomic<std::uint32_t> stage;
    std::atomic<std::uint32_t> done; // updates of this batch
    std::uint32_t refused;           // 1: `text` says why
    std::array<char, 1000> text;
    std::array<RendererItem, kRendererBatch> items;
    // The scene, behind this structure: vertices, corners, and texts that end in 0, in the order of fsr_scene.
    std::uint64_t vertex_count, triangle_count;
    std::uint64_t surface_bytes, toml_bytes, options_bytes;
    double extent, stiffness, period;
};

} // namespace forceshade
