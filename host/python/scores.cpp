// Forces of renderers in Python, scored.
#include <cmath>

#include <fmt/format.h>
#include <pybind11/stl.h>

#include "host/error.h"
#include "host/python/arrays.h"
#include "host/score/score.h"

namespace forceshade::python {
namespace {

std::vector<glm::dvec3> vectors_of(const Points& points, const char* what, std::size_t stroke) {
    if (points.ndim() != 2 || points.shape(1) != 3 || points.shape(0) == 0)
        throw UsageError("{} of stroke {}: expected an array (n, 3) with n of at least 1", what, stroke);
    std::vector<glm::dvec3> all;
    for (py::ssize_t i = 0; i < points.shape(0); ++i)
        all.emplace_back(points.at(i, 0), points.at(i, 1), points.at(i, 2));
    return all;
}

} // namespace

ScoredStrokes::ScoredStrokes(const PreparedScene& scene, const std::vector<Points>& strokes, double rate)
    : yardstick_(scene.prepared()), period_(1 / rate) {
    if (!(rate > 0 && std::isfinite(rate) && std::isfinite(period_)))
        throw UsageError("rate: {} Hz; expected samples a second, such as 1000", rate);
    if (scene.prepared().one.scene.rubs() &&
        PyErr_WarnEx(PyExc_UserWarning, "the oracle is the scene's law without its friction and vibration", 3) != 0)
        throw py::error_already_set();
    const double size = score::size_of(scene.prepared());
    for (const Points& points : strokes) {
        score::Stroke& stroke = strokes_.emplace_back();
        stroke.id = strokes_.size() - 1;
        stroke.probe = vectors_of(points, "positions", stroke.id);
        score::check_reach(fmt::format("stroke {}", stroke.id), stroke.probe, size, "Positions are in metres.");
        for (std::size_t i = 0; i < stroke.probe.size(); ++i) {
            if (!yardstick_.law().reaches(stroke.probe[i]))
                throw UsageError("stroke {}, sample {}: {}", stroke.id, i, beyond_reach<double>(stroke.probe[i]));
            stroke.time.push_back(period_ * double(i));
        }
        truths_.push_back(yardstick_.along(stroke));
    }
    if (strokes_.empty())
        throw UsageError("strokes: expected at least one array (n, 3)");
}

std::vector<Points> ScoredStrokes::oracle() const {
    std::vector<Points> all;
    for (const score::Truth& truth : truths_) {
        Points forces({py::ssize_t(truth.force.size()), py::ssize_t(3)});
        for (std::size_t i = 0; i < truth.force.size(); ++i)
            for (int axis = 0; axis < 3; ++axis)
                forces.mutable_at(py::ssize_t(i), axis) = truth.force[i][axis];
        all.push_back(std::move(forces));
    }
    return all;
}

py::dict ScoredStrokes::score(const std::vector<Points>& forces) const {
    if (forces.size() != strokes_.size())
        throw UsageError("forces of {} strokes, there are {}", forces.size(), strokes_.size());
    std::vector<std::pair<std::string, std::vector<double>>> columns;
    for (std::size_t i = 0; i < forces.size(); ++i) {
        const std::vector<glm::dvec3> own = vectors_of(forces[i], "forces", i);
        if (own.size() != strokes_[i].probe.size())
            throw UsageError("forces of stroke {}: {}, its positions are {}", i, own.size(), strokes_[i].probe.size());
        const auto named =
            score::named_measures(score::score_stroke(yardstick_, strokes_[i], truths_[i], own, {}, period_));
        for (std::size_t column = 0; column < named.size(); ++column) {
            if (i == 0)
                columns.emplace_back(named[column].first, std::vector<double>());
            columns[column].second.push_back(named[column].second);
        }
    }
    py::dict scores;
    for (const auto& [name, values] : columns)
        scores[name.c_str()] = py::array_t<double>(py::ssize_t(values.size()), values.data());
    return scores;
}

} // namespace forceshade::python
