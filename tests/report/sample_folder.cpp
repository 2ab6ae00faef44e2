#include "tests/report/sample_folder.h"

#include <cmath>
#include <random>

#include <nlohmann/json.hpp>

#include "host/output/exr_volume.h"
#include "host/output/files.h"
#include "host/study/study_data.h"
#include "tests/report/samples.h"

namespace forceshade::testing {
namespace {

// Nothing in the upper half; below, a force that grows with depth and leans with x and y.
std::vector<float> forces(const SampleCase& one) {
    std::vector<float> values;
    std::mt19937 random(1);
    const std::size_t ny = one.alike_in_y ? 1 : one.size[1];
    for (std::size_t z = 0; z < one.size[2]; ++z)
        for (std::size_t y = 0; y < ny; ++y)
            for (std::size_t x = 0; x < one.size[0]; ++x) {
                const double depth = 0.5 - double(z) / double(one.size[2]);
                const double lean = double(x) / double(one.size[0]) - 0.5 + 0.1 * double(y);
                for (const double part : {lean, 0.3 * double(y), 1.0})
                    values.push_back(one.noise   ? static_cast<float>(random()) * 1e-9f - 2.0f
                                     : depth > 0 ? static_cast<float>(one.strength * depth * part)
                                                 : 0.0f);
            }
    return values;
}

// Two strokes along x, 1 mm below z = 0, the proxies above them; 2 N, and 0.2 N less a sample.
FileRecord write_paths_of(const std::filesystem::path& file, const std::string& scene) {
    constexpr std::array<layout::uint, 2> kSteps{11, 6};
    PathVolumeHeader header;
    header.steps = kSteps[0];
    header.paths = kSteps.size();
    header.rate = 1000;
    header.scene = scene;
    header.channels = layout::kChannelForce | layout::kChannelPosition | layout::kChannelProxy;
    std::vector<float> position, force, proxy;
    for (std::size_t path = 0; path < kSteps.size(); ++path)
        for (std::size_t step = 0; step < kSteps[0]; ++step) {
            const float x = -0.01f + 0.002f * static_cast<float>(step), y = 0.001f * static_cast<float>(path);
            position.insert(position.end(), {x, y, -0.001f});
            proxy.insert(proxy.end(), {x, y, 0});
            force.insert(force.end(), {0, 0, 2 - 0.2f * static_cast<float>(step)});
        }
    PathVolumeWriter writer(file, header);
    PathRows<float> rows;
    rows.path_count = kSteps.size();
    rows.pitch = kSteps[0];
    rows.steps = kSteps;
    rows.position = position;
    rows.force = force;
    rows.proxy = proxy;
    writer.write(rows);
    const VolumeResult result = writer.finish();
    return {file.filename().string(), result.sha256, result.bytes};
}

} // namespace

CaseRecord write_sample_case(const std::filesystem::path& folder, const SampleCase& one) {
    VolumeHeader header;
    header.size = one.size;
    header.origin = {-0.0115, one.first_y, -0.004};
    header.spacing = {0.001, one.y_spacing, 0.0005};
    header.scene = one.scene;
    header.omitted = one.alike_in_y ? "texture, 5 of 6 y samples, alike" : "texture";
    if (one.compared)
        header.channels |= kComparedChannels;
    VolumeWriter writer(folder / (one.name + ".exr"), header);
    const std::vector<float> values = forces(one);
    std::vector<float> angle, error;
    for (std::size_t i = 0; one.compared && i < values.size() / 3; ++i) {
        const bool contact = values[3 * i + 2] != 0;
        angle.push_back(contact ? 2 * static_cast<float>(i % one.size[0]) : NAN);
        error.push_back(contact ? -0.25f : NAN);
    }
    writer.write(layout::FieldChunk<float>{one.size[0],
                                           one.size[0],
                                           0,
                                           one.alike_in_y ? 1 : one.size[1],
                                           0,
                                           one.size[2],
                                           values,
                                           {},
                                           {},
                                           {},
                                           {},
                                           angle,
                                           error},
                 one.alike_in_y ? one.size[1] : 1);
    const VolumeResult result = writer.finish();
    CaseRecord record;
    record.name = one.name;
    record.parameters = {{"shading", one.name.ends_with("none") ? "none" : "reference"}};
    record.precision = "f32";
    record.engine = {};
    record.engine.engine = "gpu";
    record.engine.device = "a device";
    record.files = {{one.name + ".exr", result.sha256, result.bytes}};
    if (one.paths)
        record.files.push_back(write_paths_of(folder / (one.name + ".paths.exr"), one.scene));
    if (one.compared)
        record.deviation = {
            .from = "a sphere", .angles = 1, .rms_angle = 20, .magnitudes = 1, .rms_magnitude_error = 0.25};
    record.omitted = {"texture"};
    record.voxels = one.size[0] * one.size[1] * one.size[2];
    record.evaluated = record.voxels;
    record.largest_force = result.largest_force;
    record.error.compared = record.voxels;
    record.error.largest = 1e-7;
    record.error.largest_force = result.largest_force;
    record.engine_times.kernel = 0.002;
    record.volume_times.encode = 0.004;
    return record;
}

void write_sample_manifest(const std::filesystem::path& folder, const std::vector<CaseRecord>& records) {
    nlohmann::ordered_json json{{"format", kManifestFormat},
                                {"program", "0.1.0+sample"},
                                {"cases_of_study", records.size()},
                                {"cases_recorded", records.size()},
                                {"complete", true},
                                {"last_run", {{"device", "a device"}, {"driver", "a driver"}, {"wall_s", 1.5}}},
                                {"cases", nlohmann::ordered_json::array()}};
    for (const CaseRecord& record : records)
        json["cases"].push_back(nlohmann::ordered_json::parse(record_json(record)));
    write_file_atomically(folder / "manifest.json", json.dump(2));
}

std::vector<CaseRecord> write_sample_sweep(const std::filesystem::path& folder) {
    std::vector<CaseRecord> records{write_sample_case(folder, {}),
                                    write_sample_case(folder, {.name = "bump_shading-reference", .strength = 2})};
    write_sample_manifest(folder, records);
    return records;
}

void write_sample_study(const std::filesystem::path& folder, const std::string& scene) {
    std::filesystem::create_directories(folder);
    study::StudyData data = sample_study();
    data.scene = scene;
    data.findings = {{"sample", "A sample study finds this.", data.figures.front().name, "here", "now", "for sure"}};
    study::write_data(folder, data, study::figure_files(data));
}

} // namespace forceshade::testing
