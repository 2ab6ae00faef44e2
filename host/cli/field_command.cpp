// forceshade field.
#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/cases/case_files.h"
#include "host/cases/case_pipeline.h"
#include "host/cli/command.h"
#include "host/error.h"
#include "host/long_run.h"
#include "host/output/files.h"
#include "host/scene/value.h"

namespace forceshade {

namespace {

struct FieldArguments {
    std::string scene, out, slice, view, renderer;
    std::vector<std::string> also;
    PictureChoice pictures;
};

// Files next to a volume.
std::vector<std::filesystem::path> in_folder(const std::filesystem::path& volume,
                                             const std::vector<std::string>& names) {
    std::vector<std::filesystem::path> files;
    files.reserve(names.size());
    for (const std::string& name : names)
        files.push_back(volume.parent_path() / name);
    return files;
}

/// "magnitude". \throws UsageError with the names that there are.
picture::Quantity quantity_named(const std::string& name) {
    const auto found = std::ranges::find(picture::kQuantityNames, name);
    if (found == picture::kQuantityNames.end())
        throw UsageError("--quantity {}: there are {}", name, fmt::join(picture::kQuantityNames, ", "));
    return static_cast<picture::Quantity>(found - picture::kQuantityNames.begin());
}

/// "y=2 mm", or "y" for the middle. \throws UsageError for other text and for a plane outside of the grid.
void read_slice(const std::string& text, const GridSpec& grid, picture::SliceChoice& slice) {
    const auto axis = std::string_view("xyz").find(text.front());
    if (axis == std::string_view::npos || (text.size() > 1 && text[1] != '='))
        throw UsageError("--slice {}: write x, y or z, or as in \"y=2 mm\" where", text);
    slice.axis = axis;
    if (text.size() == 1)
        return;
    slice.at = option_quantity("--slice", text.substr(2), Dimension::length);
    const double low = grid.origin[axis], high = grid.last(axis);
    if (const double border = grid.spacing[axis] / 2; !(*slice.at >= low - border && *slice.at <= high + border))
        throw UsageError("--slice {}: the grid goes from {} = {:.6g} mm to {:.6g} mm", text, text.front(), low * 1e3,
                         high * 1e3);
}

/// "1,-1,0.5". \throws UsageError for other text, and for 0.
std::array<double, 3> read_view(const std::string& text) {
    const std::vector<std::string> parts = split(text, ',');
    std::array<double, 3> view{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto number = parts.size() == 3 ? number_in(parts[axis], -1e9, 1e9) : std::nullopt;
        if (!number)
            throw UsageError("--view {}: write a direction as x,y,z, as in 1,-1,0.5", text);
        view[axis] = *number;
    }
    if (view == std::array<double, 3>{})
        throw UsageError("--view {}: 0,0,0 is no direction", text);
    return view;
}

PictureChoice picture_choice(const FieldArguments& arguments, const Scene& scene, const picture::Endings& wanted) {
    PictureChoice choice = arguments.pictures;
    if (!arguments.slice.empty())
        read_slice(arguments.slice, scene.grid, choice.slice);
    if (!arguments.view.empty()) {
        choice.view = read_view(arguments.view);
        if (scene.surface.kind != SurfaceKind::mesh)
            throw UsageError("--view {}: is for meshes, of which *.turns shows the surface", arguments.view);
    }
    refuse_unused(wanted, choice.look == picture::Look{} && arguments.slice.empty() && arguments.view.empty() &&
                              choice.slice.quantity == picture::Quantity::magnitude);
    if (choice.slice.quantity == picture::Quantity::angle && !(scene.output.channels & layout::kChannelUnshaded))
        throw UsageError("--quantity turn: the scene computes no unshaded force: write channels = [\"force\", "
                         "\"unshaded\"] under [output]");
    return choice;
}

int run(const FieldArguments& arguments, const CommonOptions& common) {
    const LongRun long_run(common.quiet);
    const std::filesystem::path volume = arguments.out;
    if (volume.extension() != ".exr")
        throw UsageError("--out {}: a volume is an OpenEXR file, so its name ends in .exr", arguments.out);
    CaseJob job;
    CasePreparation preparation;
    job.prepared = prepare_scene(preparation, load_scene(arguments.scene, common), common);
    if (!job.prepared.one.scene.field)
        throw UsageError(
            "{}: this scene has [paths] and no [grid], so it has no field: add a [grid], or use forceshade explore",
            arguments.scene);
    job.prepared.one.scene.paths.reset(); // they are explore's
    job.prepared.one.scene.grid.every_y = !arguments.renderer.empty();
    job.volume = std::filesystem::absolute(volume);
    job.also = parse_also(arguments.also);
    if (!may_write(in_folder(job.volume, file_names(volume.stem().string(), job.prepared.one, job.also)), common))
        return 0;
    clear_stale_temporaries(job.volume.parent_path());
    job.prepared.one.name = volume.stem().string(); // the record's
    print_warnings(job.prepared.warnings, common);
    const Scene& scene = job.prepared.one.scene;
    const auto engine = make_engine(arguments.renderer, job.prepared, common, field_workload(scene));
    job.pictures = picture_choice(arguments, job.prepared.one.scene, job.also.pictures);
    Forecast needed = forecast(scene, job.also);
    require_space(job.volume.parent_path(), needed);
    if (is_space_doubtful(job.volume.parent_path(), needed)) {
        measure(
            *engine, {&job.prepared.one}, [&](const Case&) { return job; }, needed);
        if (const std::string warning = space_warning(job.volume.parent_path(), needed); !warning.empty())
            print_warnings({warning}, common);
    }
    const CaseRecord record = run_case(*engine, job);
    print_stage_times(record.engine_times, record.volume_times);
    note(common,
         "{}: {} voxels ({} evaluated) on {}, largest force {:.4g} N, error against the oracle in double "
         "precision {:.2g} of it{}\n",
         arguments.out, record.voxels, record.evaluated, record.engine.device, record.largest_force,
         record.error.relative(),
         record.error.on_edge ? fmt::format(", {} voxels on facet edges excluded", record.error.on_edge) : "");
    note(common, "{}\n", left_out_text(record));
    if (record.deviation)
        note(common, "{}", deviation_text(*record.deviation));
    if (record.files.size() > 1)
        note(common, "wrote {}\n", names_of(record.files));
    if (record.largest_force == 0 && record.error.largest_force > 0)
        note(common,
             "warning: the forces (max {:.3g} N) underflow 32-bit floats: the EXR volume is all zeros; with "
             "--precision f64, --also npy keeps them\n",
             record.error.largest_force);
    else if (record.largest_force == 0)
        note(common, "warning: no voxel of the grid is in contact, so the force is 0 everywhere\n");
    if (common.json)
        print_data(record_json(record) + "\n");
    if (const std::string wrong = error_text(record); !wrong.empty() && arguments.renderer.empty())
        throw Error(ExitCode::failed, wrong);
    return 0;
}

void describe(Options& options, FieldArguments& arguments) {
    options.required("SCENE", arguments.scene, "scene file (TOML)");
    options.required("--out FILE", arguments.out, "the volume, an .exr file");
    options.list("--also vti|vtp|npy|png|svg|pdf", arguments.also,
                 "further files next to it: vti (ParaView: the field), vtp (ParaView: the surface with the forces on "
                 "it), npy (NumPy), png, svg, pdf (pictures)");
    describe_look(options, arguments.pictures.look);
    options.read(
        "--quantity magnitude|x|y|z|direction|turn",
        [&](const std::string& text) { arguments.pictures.slice.quantity = quantity_named(text); },
        "that the colours show: magnitude (default), a component, the direction, or the turn: the angle between the "
        "forces with and without shading");
    options.read(
        "--full-scale FORCE",
        [&](const std::string& text) {
            arguments.pictures.look.full_scale = option_quantity("--full-scale", text, Dimension::force);
            if (!(arguments.pictures.look.full_scale > 0))
                throw UsageError("--full-scale {}: write a force above 0, as in 5 N", text);
        },
        "where the colours of forces end; by default the force of a hand that presses 2 mm deep");
    describe_renderer(options, arguments.renderer);
    options.optional("--slice PLANE", arguments.slice,
                     "of *.arrows and *.shading: x, y or z, in the middle or as in \"y=2 mm\"; by default y");
    options.optional("--view X,Y,Z", arguments.view,
                     "of *.turns, a mesh under each shading: from where it is seen; by default 0.9,-1.3,0.8");
    options
        .example("field bump.toml --out bump.exr --also png,npy",
                 "the forces of a scene, as pictures and for NumPy, too")
        .example("field bump.toml -o turned.exr --also svg --quantity direction --slice \"y=2 mm\"",
                 "the directions in another plane");
}

} // namespace

void add_field_command(CommandLine& program) {
    program.add<FieldArguments>("field", "Evaluate one scene into an EXR volume", run, describe);
}

} // namespace forceshade
