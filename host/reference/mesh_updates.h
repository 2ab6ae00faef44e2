// L6: updates of many god-objects that kernels leave to the host, each as update() does it.
#pragma once

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

#include "host/reference/god_object.h"

namespace forceshade::reference {

template <typename T>
void finish_update(const layout::MeshView<T>& mesh, Neighbourhood<T>& around, layout::MeshUpdate<T>& one) noexcept {
    GodObject<T> state;
    state.proxy = {one.proxy[0], one.proxy[1], one.proxy[2]};
    std::copy(one.triangles, one.triangles + 3, state.triangles);
    state.count = one.count;
    state.cornered = one.cornered;
    state.started = true;
    const GodObjectContact<T> contact =
        update(mesh, state, around, Vector<T>(one.probe[0], one.probe[1], one.probe[2]));
    for (int i = 0; i < 3; ++i) {
        one.proxy[i] = state.proxy[i];
        one.rest[i] = contact.proxy[i];
    }
    std::copy(state.triangles, state.triangles + 3, one.triangles);
    one.count = state.count;
    one.cornered = state.cornered;
    one.touching = contact.touching;
    one.finished = contact.finished;
    one.triangle = contact.touching ? contact.triangles[0] : 0;
    one.back =
        contact.touching && dot(contact.normals[0], vector_at(mesh.triangle_normals, contact.triangles[0])) < T(0);
}

/// On so many threads; none depends on another.
template <typename T>
void finish_updates(const layout::MeshView<T>& mesh, std::span<layout::MeshUpdate<T>> updates, unsigned threads) {
    constexpr std::size_t kShare = 16; // that a thread takes at once
    std::atomic<std::size_t> next{0};
    const auto work = [&] {
        Neighbourhood<T> around;
        for (std::size_t begin; (begin = kShare * next++) < updates.size();)
            for (layout::MeshUpdate<T>& one : updates.subspan(begin, std::min(kShare, updates.size() - begin)))
                finish_update(mesh, around, one);
    };
    std::vector<std::jthread> helpers;
    for (std::size_t i = 1; i < std::min<std::size_t>(threads, updates.size() / kShare); ++i)
        helpers.emplace_back(work);
    work();
}

} // namespace forceshade::reference
