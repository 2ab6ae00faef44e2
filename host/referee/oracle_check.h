// The error of an evaluated field against the oracle in double precision, gathered while its chunks pass by.
#pragma once

#include <cstdint>

#include "host/output/record.h"
#include "host/prepare/prepared_case.h"
#include "host/referee/rounding_bound.h"
#include "shaders/shared/law.h"

namespace forceshade {

/// Compares evenly chosen rows, all of them where the grid is small, so that the cost is bounded.
class OracleCheck {
public:
    /// Of what varies in a case, which must outlive this; `exact_bits`: the engine must equal the oracle bit for bit.
    OracleCheck(const PreparedCase& prepared, bool exact_bits);

    void add(const layout::FieldChunk<float>& chunk);
    void add(const layout::FieldChunk<double>& chunk);
    const OracleError& error() const { return error_; }

private:
    template <typename T> void compare(const layout::FieldChunk<T>& chunk, const FieldTables<T>& same);
    bool is_beyond(const glm::dvec3& force, double off, const glm::dvec3& probe);
    bool crosses_edge(const glm::dvec3& force, const glm::dvec3& truth, const glm::dvec3& exact_probe,
                      const glm::dvec3& probe);
    MeshBound& mesh_bound();

    const PreparedCase& prepared_;
    bool exact_bits_;

    FieldTables<double> exact_;
    std::optional<FieldTables<float>> single_;   // the oracle in single precision, where the run is
    std::optional<RoundingBound> bound_;         // made when first asked for
    std::optional<FieldTables<double>> rounded_; // of the scene as single precision holds it; likewise
    std::optional<MeshBound> mesh_bound_;        // likewise
    std::uint64_t every_;                        // rows: one in so many is compared
    OracleError error_;
};

} // namespace forceshade
