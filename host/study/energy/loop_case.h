// A surface, a shading, and a loop below it: what is reported of it.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "host/engine/engine.h"
#include "host/prepare/prepared_case.h"
#include "host/reference/surfaces.h"
#include "host/study/energy/loop_work.h"

namespace forceshade::study {

struct LoopCase {
    std::string surface;       /* as the table has it: "bump", "mesh of triangles" */
    std::string scheme;        /* what tells curves apart: "bump, unshaded" */
    std::string loop = "half"; /* "half": from the middle to one side; "whole": from side to side */
    unsigned facets = 0;       /* or cells, over the bump's width; 0: smooth */
    double radius_mil = 0;     /* R, mil; 0: none */
    PreparedCase prepared;
    std::vector<Section> sections;                    /* loops at several y; their work is averaged */
    double out = 0.002, back = 0.001;                 /* m: vertical depths of the two legs */
    std::function<Vector(double x, double y)> smooth; /* the normal of the shape that is meant; empty: unknown */
    std::optional<double> closed_form;                /* J */
    Pieces pieces;
    int steps = 2048;        /* of a leg, on the engine */
    bool god_object = false; /* of a mesh: with the history of L6 rather than the static field */
};

/// The scene's law in double precision at a place in the world, m.
class PlacedLaw {
public:
    explicit PlacedLaw(const PreparedCase& prepared);
    reference::Contact<double> operator()(const Vector& place) const;
    /// Which smooth piece of the force the place is in: its facet; of a cylinder bump also which of plane and cylinder
    /// are touched there.
    layout::uint piece(const Vector& place) const;
    const layout::Law<double>& law() const { return law_; }

private:
    FieldTables<double> tables_;
    layout::Law<double> law_; // points into the tables
};

/// A row of the table of loops: work and effort in mJ from quadrature (static) or from the oracle's samples
/// (god-object), the engine's, the closed form, direction errors in degrees.
nlohmann::ordered_json loop_row(const LoopCase& one, Engine& engine);

} // namespace forceshade::study
