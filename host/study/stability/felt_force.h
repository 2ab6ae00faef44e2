// A surface's force, by the CPU oracle in double, at a probe that came down to a place.
#pragma once

#include <memory>

#include "host/study/error_time/law_at.h"
#include "host/study/stability/surfaces.h"

namespace forceshade::study {

class FeltForce {
public:
    /// `surface` must outlive it.
    explicit FeltForce(const LoopSurface& surface) : surface_(surface) {
        scale_.deepest = surface.deepest;
        if (surface.is_mesh())
            proxy_ = std::make_unique<error_time::ProxyLaw<double>>(surface.prepared);
        else
            direct_ = std::make_unique<error_time::DirectLaw<double>>(surface.prepared);
    }

    /// m, for each N/m of stiffness: at the place, `aside` of it.
    glm::dvec3 operator()(const error_time::Place& place, const glm::dvec3& aside = glm::dvec3(0)) {
        const glm::dvec3 at = place.at + aside;
        if (direct_)
            return glm::dvec3(
                direct_->at(error_time::rounded_places<double>(surface_.prepared, std::span(&at, 1))[0]).force);
        std::vector<glm::dvec3> way = error_time::descent(place, scale_);
        if (aside != glm::dvec3(0))
            way.push_back(at);
        return glm::dvec3(proxy_->force(error_time::rounded_places<double>(surface_.prepared, way)));
    }

private:
    const LoopSurface& surface_;
    error_time::TouchScale scale_;
    std::unique_ptr<error_time::DirectLaw<double>> direct_;
    std::unique_ptr<error_time::ProxyLaw<double>> proxy_;
};

} // namespace forceshade::study
