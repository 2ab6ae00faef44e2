// L6 static over a grid as a plan has it: the `--engine cpu` of a mesh's field. Voxels outside of the plan are out of
// contact, and only a block's candidates are tested; the same bits as evaluate_field() without a plan.
#pragma once

#include <cstddef>
#include <functional>

#include "host/reference/field.h"

namespace forceshade::reference {

/// The plan of the samples z in [z_first, z_first + z_count), z_first even; valid until it is asked for the next.
using PlanLayers = std::function<layout::MeshPlan(std::size_t z_first, std::size_t z_count)>;

/// As evaluate_field(), of a mesh.
template <typename T>
void evaluate_mesh_field(const layout::FieldInput<T>& input, const FieldOptions& options, const PlanLayers& plan,
                         const std::function<void(const layout::FieldChunk<T>&)>& consume);

} // namespace forceshade::reference
