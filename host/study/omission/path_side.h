// Paths through a law as a setup wants them: what they take, and what they give.
#pragma once

#include <memory>

#include "host/paths/scene_paths.h"
#include "host/study/omission/side.h"

namespace forceshade::study {

/// The paths of the setup's scene.
template <typename T> class PathSide final : public Side<T> {
public:
    /// `setup` must outlive it.
    explicit PathSide(const Setup& setup);

    Cost measure(Engine& engine) override;
    Captured<T> capture(Engine& engine, std::uint32_t channels) override;
    std::size_t samples() const override;

private:
    layout::PathInput<T> input();

    const Setup& setup_;
    std::unique_ptr<ScenePaths<T>> paths_;
};

extern template class PathSide<float>;
extern template class PathSide<double>;

} // namespace forceshade::study
