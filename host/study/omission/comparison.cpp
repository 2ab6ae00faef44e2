#include "host/study/omission/comparison.h"

#include <algorithm>

#include <fmt/format.h>

#include "host/prepare/prepared_case.h"
#include "host/study/omission/usual_features.h"

namespace forceshade::study {
namespace {

constexpr std::uint32_t kDepth = layout::kChannelDepth, kFacet = layout::kChannelFacet;
constexpr std::uint32_t kProxy = layout::kChannelProxy, kUnshaded = layout::kChannelUnshaded;

bool is_mesh(const Scene& scene) {
    return scene.surface.kind == SurfaceKind::mesh;
}

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

    Comparison& add(const std::string& feature, const char* with, const char* without) {
        Comparison& one = made_.emplace_back();
        one.feature = feature;
        one.scene = base_.name;
        one.with = {base_.prepared, with};
        one.without = {base_.prepared, without};
        one.paths = paths_;
        for (Setup* setup : {&one.with, &one.without})
            setup->prepared.one.scene.field = !paths_;
        return one;
    }
    static void compare_nothing(Comparison& one, const char* why) {
        one.force = Agreement::nothing;
        one.channels = 0;
        one.why_nothing = why;
    }
    static Scene& scene_of(Setup& setup) { return setup.prepared.one.scene; }

    // A proxy, a Gaussian and an image tell one y from another: so that these are switched alone, both sides are
    // evaluated at every y.
    static void evaluate_same_y(Comparison& one) {
        const auto varies = [](Setup& setup) { return depends_on_y(features_of(scene_of(setup))); };
        if (!one.forced && varies(one.with) != varies(one.without))
            one.with.extent = one.without.extent = Extent::everything;
    }

    void add_shading() {
        const Shading given = scene().force.shading;
        const Shading shading = given == Shading::none ? usual_shading(scene().surface.kind) : given;
        if (shading == Shading::none)
            return;
        Comparison& one = add("shading", name_of(shading), "none");
        scene_of(one.with).force.shading = shading;
        scene_of(one.without).force.shading = Shading::none;
        one.omitted = "shading";
        one.channels = kDepth | kFacet | kProxy;
        // Texture adds to the shaded force; two_pass is stronger by its law.
        const bool keeps_magnitude = !scene().texture && shading != Shading::two_pass;
        one.force = keeps_magnitude ? Agreement::magnitude : Agreement::contact;
        one.unshaded_is_force = !paths_ && (!scene().texture || scene().texture->effect == TextureEffect::force);
    }

    void add_texture(const char* feature, const char* what, Agreement force, const TextureSpec& texture) {
        Comparison& one = add(feature, what, "none");
        scene_of(one.with).texture = texture;
        scene_of(one.without).texture.reset();
        one.without.prepared.images.texture.reset();
        if (!texture.map.path.empty())
            one.with.prepared.images.texture = base_.prepared.images.texture;
        one.omitted = texture.effect == TextureEffect::normal ? "tilted normals" : "texture";
        one.channels = kDepth | kFacet | kProxy;
        one.force = force;
    }

    void add_textures() {
        TextureSpec texture = usual_texture(base_.prepared, TextureEffect::force);
        const bool own = scene().texture && scene().texture->effect == TextureEffect::force;
        if (own)
            texture = *scene().texture;
        const Agreement tangential = is_mesh(scene()) ? Agreement::contact : Agreement::along_z;
        add_texture("texture", own ? "the scene's" : "a sine of 12 waves", tangential, texture);
        TextureSpec flat = usual_texture(base_.prepared, TextureEffect::force);
        flat.map.height = 0;
        add_texture("flat texture", "a sine of height 0", Agreement::values, flat);
        if (!is_mesh(scene()))
            return;
        TextureSpec tilt = usual_texture(base_.prepared, TextureEffect::normal);
        if (scene().texture && !own)
            tilt = *scene().texture;
        const bool keeps_magnitude = scene().force.shading != Shading::two_pass;
        add_texture("tilted normals", "a bump map", keeps_magnitude ? Agreement::magnitude : Agreement::contact, tilt);
    }

    // The same map as a function and as an image.
    void add_samples() {
        Comparison& one = add("sampled map", "an image of 129 x 129", "a function");
        one.omitted = "sampled height maps";
        one.channels = kDepth | kFacet | kProxy;
        const HeightMapSpec& map = scene().surface.map;
        if (scene().surface.kind == SurfaceKind::height_map && scene().force.shading == Shading::height_map &&
            (map.function == MapFunction::sine || map.function == MapFunction::gaussian) && !scene().texture) {
            one.with.prepared.images.map = sample_map(scene_of(one.with).surface.map);
            one.force = Agreement::magnitude;
            return;
        }
        const TextureSpec texture = usual_texture(base_.prepared, TextureEffect::force);
        scene_of(one.with).texture = scene_of(one.without).texture = texture;
        one.with.prepared.images.texture = sample_map(scene_of(one.with).texture->map);
        one.force = is_mesh(scene()) ? Agreement::contact : Agreement::along_z;
        if (features_of(scene_of(one.without)).map == layout::kMapSamples)
            one.omitted.clear(); // the scene has another one
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
        one.forced = true;
        one.channels = kDepth | kFacet | kUnshaded;
    }

    void add_mesh() {
        Comparison& winding = add("winding number", "winding", "pseudonormal");
        scene_of(winding.with).surface.mesh.inside = InsideTest::winding;
        scene_of(winding.without).surface.mesh.inside = InsideTest::pseudonormal;
        winding.omitted = winding.feature;
        winding.channels = kDepth | kFacet | kProxy | kUnshaded;
        if (!is_solid(base_.prepared.images.mesh->findings))
            compare_nothing(winding,
                            "what the winding number takes for the inside of a mesh that is no solid is its own");
        if (!gpu_)
            return;
        Comparison& free = add("free space", "every block visited", "skipped");
        free.with.free = FreeSpace::visited;
        free.omitted = "blocks of free space";
        free.forced = true;
        free.channels = kDepth | kFacet | kProxy | kUnshaded;
    }

    // Both sides alike: what still lies between them is the measurement's.
    void add_control() { add(kControl, "the scene", "the scene").channels = scene().output.channels; }

    void add_field() {
        paths_ = false;
        add_control();
        add_shading();
        add_textures();
        add_samples();
        add_channel("depth", kDepth);
        add_channel("facet", kFacet);
        add_channel("proxy", kProxy);
        add_channel("unshaded", kUnshaded);
        add_y();
        if (is_mesh(scene()))
            add_mesh();
    }

    void add_paths() {
        paths_ = true;
        Comparison& samples = add(base_.field ? "path samples" : "samples", "written", "metrics alone");
        samples.without.samples = false;
        samples.force = Agreement::none;
        if (base_.field)
            return;
        add_control();
        const std::size_t first = made_.size();
        add_shading();
        add_textures();
        add_samples();
        // In closed loop a probe goes where the force lets it.
        if (scene().paths->closed())
            for (std::size_t i = first; i < made_.size(); ++i)
                compare_nothing(made_[i], "in closed loop the feature moves the probe");
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

std::vector<std::string> omitted_by(const Setup& setup) {
    return omissions(setup.prepared.one.scene);
}

bool same_forces(const Comparison& comparison) {
    return comparison.force == Agreement::bits || comparison.force == Agreement::values ||
           comparison.force == Agreement::none;
}

bool agrees_with_manifest(const Comparison& comparison) {
    const auto tells = [&](const Setup& setup) {
        const std::vector<std::string> omitted = omitted_by(setup);
        return std::ranges::find(omitted, comparison.omitted) != omitted.end();
    };
    if (comparison.omitted.empty())
        return true;
    return tells(comparison.without) && (comparison.forced || !tells(comparison.with));
}

std::vector<Comparison> comparisons_of(const BaseScene& base, bool gpu) {
    return Comparisons(base, gpu).all();
}

} // namespace forceshade::study
