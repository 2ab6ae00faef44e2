#include "device/loop/live_law.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "host/output/files.h"
#include "host/prepare/prepared_case.h"

namespace forceshade::device {

namespace {

// `origin`, m: what the contact's proxy is measured from.
template <typename T>
LiveContact as_live(const reference::Contact<T>& contact, const glm::dvec3& origin, bool finished = true) noexcept {
    return {world_place(glm::dvec3(contact.proxy), origin), glm::dvec3(contact.force), double(contact.depth),
            contact.facet, finished};
}

// What every law has in common: the case and its tables.
template <typename T> class TabledLaw : public LiveLaw {
public:
    explicit TabledLaw(PreparedCase prepared)
        : prepared_(std::move(prepared)), origin_(scene_origin(prepared_)),
          tables_(make_tables<T>(prepared_.one.scene, prepared_.images, Extent::what_varies)), law_(tables_.law()) {}

    bool reaches(const glm::dvec3& probe) const noexcept override {
        return std::abs(probe.x) <= kLargestLength<T> && std::abs(probe.y) <= kLargestLength<T> &&
               std::abs(probe.z) <= kLargestLength<T>;
    }

protected:
    PreparedCase prepared_;
    glm::dvec3 origin_; /* m, in the world */
    FieldTables<T> tables_;
    layout::Law<T> law_; // points into the tables
};

// L1 to L5: no history.
template <typename T> class SurfaceLaw final : public TabledLaw<T> {
public:
    using TabledLaw<T>::TabledLaw;

    void begin_path() noexcept override {}

    LiveContact at(const glm::dvec3& probe) noexcept override {
        return as_live(reference::evaluate(this->law_, reference::Vector<T>(probe)), this->origin_);
    }
};

// L6 to L9: the god-object.
template <typename T> class MeshLaw final : public TabledLaw<T> {
public:
    explicit MeshLaw(PreparedCase prepared) : TabledLaw<T>(std::move(prepared)) {
        find_obstacles(this->tables_);
        this->law_ = this->tables_.law();
    }

    bool reaches(const glm::dvec3& probe) const noexcept override {
        return TabledLaw<T>::reaches(probe) && is_within_reach(local(place_of(probe)));
    }

    void begin_path() noexcept override { begun_ = false; }

    LiveContact at(const glm::dvec3& probe) noexcept override {
        const reference::Vector<T> place = place_of(probe), at = local(place);
        if (!std::exchange(begun_, true))
            begin_probe(this->law_, around_, proxy_, at);
        const PathContact<T> found = follow_probe(this->law_, around_, proxy_, place, at);
        return as_live(found.contact, this->origin_, found.finished);
    }

private:
    reference::Vector<T> place_of(const glm::dvec3& probe) const noexcept {
        return reference::Vector<T>(probe - this->origin_);
    }
    reference::Vector<T> local(const reference::Vector<T>& place) const noexcept {
        return reference::to_mesh_frame(this->law_.mesh.params, place);
    }

    reference::Neighbourhood<T> around_;
    reference::GodObject<T> proxy_;
    bool begun_ = false;
};

template <typename T> std::unique_ptr<LiveLaw> make(PreparedCase prepared) {
    if (prepared.one.scene.surface.kind == SurfaceKind::mesh)
        return std::make_unique<MeshLaw<T>>(std::move(prepared));
    return std::make_unique<SurfaceLaw<T>>(std::move(prepared));
}

} // namespace

std::unique_ptr<LiveLaw> make_live_law(PreparedCase prepared) {
    const std::string digest = sha256_of(prepared.scene);
    std::unique_ptr<LiveLaw> law = prepared.one.scene.precision == Precision::f32 ? make<float>(std::move(prepared))
                                                                                  : make<double>(std::move(prepared));
    std::from_chars(digest.data(), digest.data() + 16, law->scene, 16);
    return law;
}

} // namespace forceshade::device
