#include "host/study/omission/comparison.h"

#include <algorithm>

#include <fmt/format.h>

namespace forceshade::study {
namespace {

constexpr std::uint32_t kDepth = layout::kChannelDepth, kFacet = layout::kChannelFacet;
constexpr std::uint32_t kProxy = layout::kChannelProxy, kUnshaded = layout::kChannelUnshaded;

class Comparisons {
public:
    Comparisons(const BaseScene& base, bool gpu) : base_(base), gpu_(gpu) {}

    std::vector<Comparison> all() {
        if (base_.field)
            add_field();
        if (base_.paths)
            add_paths();
        for (Comparison& one : made_)
            evaluate_same_y(one);
        return std::move(made_);
    }

private:
    const Scene& scene() const { return base_.prepared.one.scene; }
    static Scene& scene_of(Setup& setup) { return setup.prepared.one.scene; }

    Comparison& add(const std::string& feature, const char* with, const char* without) {
        Comparison& one = made_.emplace_back();
        one.feature = feature;
        one.scene = base_.name;
        one.with = {base_.prepared, with};
        one.without = {base_.prepared, without};
        one.paths = paths_;
        for (Setup* setup : {&one.with, &one.without})
            scene_of(*setup).field = !paths_;
        return one;
    }

    // A proxy tells one y from another: so that it is switched alone, both sides are evaluated at every y.
    static void evaluate_same_y(Comparison& one) {
        const auto varies = [](Setup& setup) { return depends_on_y(features_of(scene_of(setup))); };
        if (!one.always && varies(one.with) != varies(one.without))
            one.with.extent = one.without.extent = Extent::everything;
    }

    void add_flat_texture() {
        if (scene().texture)
            return;
        Comparison& one = add("texture of height 0", "a sine of height 0", "none");
        TextureSpec texture;
        texture.stiffness = scene().force.stiffness / 5;
        texture.map.function = MapFunction::sine;
        texture.map.width = 1e-3;
        texture.map.height = 0;
        scene_of(one.with).texture = texture;
        one.omitted = "texture";
        one.channels = kDepth | kFacet | kProxy;
        one.same = Same::values;
    }

    void add_channel(const char* name, std::uint32_t channel) {
        Comparison& one = add(fmt::format("{} channel", name), "written", "not written");
        scene_of(one.with).output.channels |= channel;
        scene_of(one.without).output.channels &= ~channel;
        one.omitted = one.feature;
        one.channels = scene().output.channels & ~channel & (kDepth | kFacet | kProxy | kUnshaded);
    }

    void add_y() {
        layout::Features features = features_of(scene());
        features.channels &= ~kProxy;
        const std::uint64_t samples = scene().grid.size[1];
        if (depends_on_y(features) || samples < 2)
            return;
        Comparison& one = add("every y", "all y samples", "one for all");
        for (Setup* setup : {&one.with, &one.without})
            scene_of(*setup).output.channels &= ~kProxy;
        one.with.extent = Extent::everything;
        one.omitted = fmt::format("{} of {} y samples, alike", samples - 1, samples);
        one.always = true;
        one.channels = kDepth | kFacet | kUnshaded;
    }

    // Of a mesh that is no solid the winding number has an inside of its own: another law.
    void add_winding() {
        if (!is_solid(base_.prepared.images.mesh->findings))
            return;
        Comparison& one = add("winding number", "winding", "pseudonormal");
        scene_of(one.with).surface.mesh.inside = InsideTest::winding;
        scene_of(one.without).surface.mesh.inside = InsideTest::pseudonormal;
        one.omitted = one.feature;
        one.channels = kDepth | kFacet | kProxy | kUnshaded;
    }

    void add_free_space() {
        Comparison& one = add("free space", "every block visited", "skipped");
        one.with.free = FreeSpace::visited;
        one.omitted = "blocks of free space";
        one.always = true;
        one.channels = kDepth | kFacet | kProxy | kUnshaded;
    }

    void add_control() { add(kControl, "the scene", "the scene").channels = scene().output.channels; }

    void add_field() {
        paths_ = false;
        add_control();
        add_flat_texture();
        add_channel("depth", kDepth);
        add_channel("facet", kFacet);
        add_channel("proxy", kProxy);
        add_channel("unshaded", kUnshaded);
        add_y();
        if (scene().surface.kind != SurfaceKind::mesh)
            return;
        add_winding();
        if (gpu_)
            add_free_space();
    }

    void add_paths() {
        paths_ = true;
        Comparison& samples = add(base_.field ? "path samples" : "samples", "written", "metrics alone");
        samples.without.samples = false;
        samples.same = Same::metrics;
        if (base_.field)
            return;
        add_control();
        add_flat_texture();
        add_channel("depth", kDepth);
        add_channel("facet", kFacet);
        add_channel("proxy", kProxy);
    }

    const BaseScene& base_;
    bool gpu_;
    bool paths_ = false;
    std::vector<Comparison> made_;
};

} // namespace

bool agrees_with_manifest(const Comparison& comparison) {
    const auto tells = [&](const Setup& setup) {
        const std::vector<std::string> omitted = omissions(setup.prepared.one.scene);
        return std::ranges::find(omitted, comparison.omitted) != omitted.end();
    };
    if (comparison.omitted.empty())
        return true;
    return tells(comparison.without) && (comparison.always || !tells(comparison.with));
}

std::vector<Comparison> comparisons_of(const BaseScene& base, bool gpu) {
    return Comparisons(base, gpu).all();
}

} // namespace forceshade::study
