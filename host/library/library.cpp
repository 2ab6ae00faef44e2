#include "host/library/forceshade.h"

#include <cmath>
#include <filesystem>
#include <span>
#include <variant>

#include "host/error.h"
#include "host/field/case_law.h"
#include "host/mesh/mesh_file.h"

namespace forceshade::oracle {

struct Scene::State {
    State(const Case& one, std::vector<std::string> remarks, const PolygonFile* mesh = nullptr)
        : prepared(CasePreparation().prepare(one, mesh)), law(law_of(prepared)), warnings(std::move(remarks)) {
        warnings.insert(warnings.end(), prepared.warnings.begin(), prepared.warnings.end());
    }

    using Law = std::variant<CaseLaw<float>, CaseLaw<double>>;
    static Law law_of(const PreparedCase& prepared) {
        if (prepared.one.scene.precision == Precision::f32)
            return CaseLaw<float>(prepared);
        return CaseLaw<double>(prepared);
    }

    PreparedCase prepared;
    Law law;
    std::vector<std::string> warnings;
};

namespace {

std::array<double, 3> as_array(const glm::dvec3& v) {
    return {v.x, v.y, v.z};
}

glm::dvec3 as_vector(const Place& place) {
    return {place[0], place[1], place[2]};
}

Touch touch_of(const ProbeContact& contact) noexcept {
    const bool touching = contact.facet != layout::kNoFacet;
    return {!contact.finished ? Status::unfinished
            : touching        ? Status::touching
                              : Status::free,
            as_array(contact.force), as_array(contact.proxy), contact.depth, touching ? long(contact.facet) : -1};
}

Touch nothing(const Place& place) noexcept {
    const bool is_number = std::isfinite(place[0]) && std::isfinite(place[1]) && std::isfinite(place[2]);
    return {is_number ? Status::out_of_range : Status::not_a_number, {}, place, 0, -1};
}

template <typename Read> auto in_words(const Read& read) {
    try {
        return read();
    } catch (const Error& error) {
        throw SceneError(error.what());
    }
}

} // namespace

Scene::Scene(std::shared_ptr<const State> state) : state_(std::move(state)) {}

Scene::Scene(const std::string& file, const Overrides& overrides)
    : state_(in_words([&] {
          std::vector<std::string> warnings;
          const Case one = read_scene(file, overrides, &warnings);
          return std::make_shared<State>(one, std::move(warnings));
      })) {}

Scene Scene::parse(const std::string& text, const std::string& folder, const Overrides& overrides) {
    return in_words([&] {
        std::vector<std::string> warnings;
        const Case one = parse_scene(text, "scene", std::filesystem::absolute(folder), overrides, &warnings);
        return Scene(std::make_shared<State>(one, std::move(warnings)));
    });
}

Scene Scene::parse(const std::string& text, const Mesh& mesh, const Overrides& overrides) {
    return in_words([&] {
        Overrides all{{"surface.file", "mesh"}};
        all.insert(all.end(), overrides.begin(), overrides.end());
        std::vector<std::string> warnings;
        const Case one = parse_scene(text, "scene", std::filesystem::absolute("."), all, &warnings);
        if (one.scene.surface.kind != SurfaceKind::mesh)
            throw UsageError("a mesh is for a scene with kind = \"mesh\" in [surface]");
        std::vector<glm::dvec3> vertices;
        for (const Place& vertex : mesh.vertices)
            vertices.push_back(as_vector(vertex));
        std::vector<std::int64_t> corners;
        std::vector<std::size_t> counts;
        for (const std::vector<int>& facet : mesh.facets) {
            corners.insert(corners.end(), facet.begin(), facet.end());
            counts.push_back(facet.size());
        }
        const PolygonFile file = polygons_of("mesh", std::move(vertices), corners, counts,
                                             one.scene.surface.mesh.normals == NormalWeights::file);
        return Scene(std::make_shared<State>(one, std::move(warnings), &file));
    });
}

const std::string& Scene::toml() const {
    return state_->prepared.scene;
}

const std::vector<std::string>& Scene::warnings() const {
    return state_->warnings;
}

Touch Scene::at(const Place& place) const noexcept {
    const glm::dvec3 probe = as_vector(place);
    const auto evaluate = [&](const auto& law) {
        return law.reaches(probe) ? touch_of(law.widened({law.at(probe)})) : nothing(place);
    };
    return std::visit(evaluate, state_->law);
}

struct Probe::State {
    std::unique_ptr<ProbeLaw> law;
};

Probe::Probe(const Scene& scene)
    : state_(std::make_unique<State>(State{in_words([&] { return make_probe_law(scene.state_->prepared); })})) {
    begin_path();
}
Probe::~Probe() = default;
Probe::Probe(Probe&&) noexcept = default;
Probe& Probe::operator=(Probe&&) noexcept = default;

Touch Probe::step(const Place& place) noexcept {
    const glm::dvec3 probe = as_vector(place);
    if (!state_->law->reaches(probe)) {
        begin_path();
        return nothing(place);
    }
    return touch_of(state_->law->at(probe));
}

void Probe::begin_path() noexcept {
    state_->law->begin_path();
}

} // namespace forceshade::oracle
