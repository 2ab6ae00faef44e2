// A prepared scene's forces as NumPy arrays: over its grid, at places, along paths. Arrays are NumPy's own and are
// filled in place, without Python's lock; what evaluates is the command line's.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include "host/field/case_law.h"
#include "host/field/comparison.h"
#include "host/field/engine.h"
#include "host/score/measures.h"

namespace forceshade::python {

namespace py = pybind11;

/// (n, 3), m.
using Numbers = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>;
using Points = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// A case and its tables, in the precision of its run. Nothing of it changes, so threads may share it.
class PreparedScene {
public:
    /// `name` is what messages call the text, files are relative to `folder`. \throws as parse_scene and prepare.
    /// `mesh` stands for the file of the scene's mesh: vertices (n, 3), corners of all facets (m), corners of each (k).
    using MeshArrays = std::tuple<Points, Numbers, Numbers>;
    PreparedScene(const std::string& text, const std::string& name, const std::string& folder,
                  const std::vector<Override>& overrides, const std::optional<MeshArrays>& mesh);

    const PreparedCase& prepared() const { return prepared_; }
    const std::vector<std::string>& warnings() const { return warnings_; }

    /// The grid's force and those of the channels "depth", "facet", "proxy" and "unshaded" that are asked for, by name;
    /// (nz, ny, nx, 3) or (nz, ny, nx), with ny = 1 where the field does not depend on y. Facets are int32, -1 out of
    /// contact. \throws UsageError for a scene without a grid.
    py::dict field(const std::vector<std::string>& channels, const EngineOptions& engine) const;
    /// The static law at each point: force, unshaded, proxy (n, 3), depth, facet (n).
    py::dict contact(const Points& points, unsigned threads) const;
    /// Whether forces are compared with the shape of [compare].
    bool compares() const { return prepared_.one.scene.compare.has_value(); }
    /// How far forces (n, 3) at points (n, 3) are from those of that shape: angle, magnitude_error (n).
    py::dict compare(const Points& points, const Points& forces, unsigned threads) const;
    /// Probes along the scene's paths or along these, each (steps, 3): position, force, proxy (paths, steps, 3), depth,
    /// facet (paths, steps), NaN and -1 behind a path's end; `figures`, the columns of PATHS.paths.csv; and `rate`, Hz.
    py::dict explore(const std::optional<std::vector<Points>>& paths, EngineOptions engine) const;

private:
    std::vector<std::string> warnings_;
    PreparedCase prepared_;
    std::optional<std::variant<CaseLaw<float>, CaseLaw<double>>> law_;
    std::optional<ShapeComparison> comparison_;
};

/// A probe with a history, as the live loop has it.
class GodObject {
public:
    explicit GodObject(std::shared_ptr<const PreparedScene> scene);
    /// The contacts of the probe at one point after the other: force, unshaded, proxy (n, 3), depth, facet (n).
    py::dict follow(const Points& points);
    /// The next point begins a path of its own.
    void reset();

private:
    template <typename T> using Probe = std::unique_ptr<CaseProbe<T>>;

    std::shared_ptr<const PreparedScene> scene_;
    std::variant<Probe<float>, Probe<double>> probe_;
};

/// Strokes over a scene, and the oracle along them, against which forces are scored.
class ScoredStrokes {
public:
    /// Strokes are (n, 3), m; a sample each 1 / `rate`, Hz. \throws UsageError for a stroke that is empty, not finite
    /// or out of the oracle's reach.
    ScoredStrokes(const PreparedScene& scene, const std::vector<Points>& strokes, double rate);
    /// N, (n, 3) of each stroke.
    std::vector<Points> oracle() const;
    /// The measures of forces, N, (n, 3) for each stroke: arrays (strokes) by name.
    py::dict score(const std::vector<Points>& forces) const;

private:
    score::Yardstick yardstick_;
    double period_; /* s */
    std::vector<score::Stroke> strokes_;
    std::vector<score::Truth> truths_;
};

/// A file of fields (all its channels, `x`, `y`, `z`, `scene`) or of paths. \throws IoError.
py::dict read_exr(const std::string& file);

} // namespace forceshade::python
