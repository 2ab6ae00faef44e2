#include "host/library/forceshade.h"

#include <cmath>
#include <filesystem>
#include <span>
#include <variant>

#include "device/loop/live_law.h"
#include "host/error.h"
#include "host/prepare/prepared_case.h"

namespace forceshade::oracle {

struct Scene::State {
    explicit State(const Case& one) : prepared(CasePreparation().prepare(one)) {
        if (prepared.one.scene.precision == Precision::f32)
            tables = make_tables<float>(prepared.one.scene, prepared.images, Extent::what_varies);
        else
            tables = make_tables<double>(prepared.one.scene, prepared.images, Extent::what_varies);
    }

    PreparedCase prepared;
    std::variant<FieldTables<float>, FieldTables<double>> tables;
    std::vector<std::string> warnings;
};

namespace {

std::array<double, 3> as_array(const glm::dvec3& v) {
    return {v.x, v.y, v.z};
}

glm::dvec3 as_vector(const Place& place) {
    return {place[0], place[1], place[2]};
}

// A float is exact as a double. `origin`, m: what the proxy is measured from.
template <typename T> Touch touch_of(const reference::Contact<T>& contact, const glm::dvec3& origin) noexcept {
    return {as_array(glm::dvec3(contact.force)), as_array(world_place(glm::dvec3(contact.proxy), origin)),
            double(contact.depth), contact.facet == layout::kNoFacet ? -1 : long(contact.facet)};
}

Touch nothing(const Place& place) noexcept {
    return {{}, place, 0, -1};
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
          auto state = std::make_shared<State>(read_scene(file, overrides, &warnings));
          state->warnings = std::move(warnings);
          return state;
      })) {}

Scene Scene::parse(const std::string& text, const std::string& folder, const Overrides& overrides) {
    return in_words([&] {
        std::vector<std::string> warnings;
        auto state = std::make_shared<State>(
            parse_scene(text, "scene", std::filesystem::absolute(folder), overrides, &warnings));
        state->warnings = std::move(warnings);
        return Scene(std::move(state));
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
    const auto evaluate = [&]<typename T>(const FieldTables<T>& tables) {
        const double farthest = std::max({std::abs(probe.x), std::abs(probe.y), std::abs(probe.z)});
        if (!(farthest <= largest_coordinate<T>(state_->prepared)) || std::isnan(probe.x + probe.y + probe.z))
            return nothing(place);
        layout::uint hint = 0;
        return touch_of(static_contact(tables.law(), state_->prepared, probe, hint), scene_origin(state_->prepared));
    };
    return std::visit(evaluate, state_->tables);
}

struct Probe::State {
    std::unique_ptr<device::LiveLaw> law;
};

Probe::Probe(const Scene& scene)
    : state_(std::make_unique<State>(State{in_words([&] { return device::make_live_law(scene.state_->prepared); })})) {
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
    const device::LiveContact contact = state_->law->at(probe);
    return {as_array(contact.force), as_array(contact.proxy), contact.depth,
            contact.facet == layout::kNoFacet ? -1 : long(contact.facet)};
}

void Probe::begin_path() noexcept {
    state_->law->begin_path();
}

} // namespace forceshade::oracle
