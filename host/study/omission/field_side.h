// The field of a setup's scene on its grid.
#pragma once

#include "host/study/omission/side.h"

namespace forceshade::study {

template <typename T> class FieldSide final : public Side<T> {
public:
    /// `setup` must outlive it.
    explicit FieldSide(const Setup& setup);

    Cost measure(Engine& engine) override;
    Captured<T> capture(Engine& engine, std::uint32_t channels) override;
    std::size_t samples() const override;

private:
    EngineTimes evaluate(Engine& engine, layout::FieldInput<T> input,
                         const std::function<void(const layout::FieldChunk<T>&)>& consume) const;

    const Setup& setup_;
    FieldTables<T> tables_;
};

extern template class FieldSide<float>;
extern template class FieldSide<double>;

} // namespace forceshade::study
