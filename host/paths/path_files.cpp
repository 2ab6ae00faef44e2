#include "host/paths/path_files.h"

#include <algorithm>
#include <charconv>
#include <limits>

#include "host/output/raw_formats.h"
#include "host/output/rows.h"

namespace forceshade {

namespace {

constexpr std::size_t kText = std::size_t(1) << 18; // bytes gathered before they are written

} // namespace

PathCsvWriter::PathCsvWriter(const std::filesystem::path& path, const PathLabels& labels)
    : file_(path), labels_(labels), text_("path,t,x,y,z,gx,gy,gz,fx,fy,fz,depth,facet\n") {}

template <typename T> void PathCsvWriter::number(T value, char after) {
    char digits[40]; // the shortest form of a double has 24 at most
    text_.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
    text_ += after;
}

template <typename T> void PathCsvWriter::add_sample(const PathRows<T>& rows, std::size_t path, std::size_t step) {
    const std::size_t at = path * rows.pitch + step - rows.step_first;
    number(labels_.id(rows.path_first + path), ',');
    number(labels_.time(rows.path_first + path, step), ',');
    for (const std::span<const T>& vector : {rows.position, rows.proxy, rows.force})
        for (std::size_t i = 0; i < 3; ++i)
            number(vector[3 * at + i], ',');
    number(rows.depth[at], ',');
    if (rows.facet[at] == layout::kNoFacet)
        text_ += "-1\n";
    else
        number(rows.facet[at], '\n');
}

template <typename T> void PathCsvWriter::add(const PathRows<T>& rows) {
    for (std::size_t path = 0; path < rows.path_count; ++path)
        for (std::size_t i = 0; i < rows.samples(path); ++i) {
            add_sample(rows, path, rows.step_first + i);
            if (text_.size() < kText)
                continue;
            file_.write(text_);
            text_.clear();
        }
}

VolumeResult PathCsvWriter::finish() {
    file_.write(text_);
    text_.clear();
    return publish_raw(file_);
}

namespace {

// The samples of a row, and where the path ends with them what fills the array's row up.
template <typename Value>
void write_row(TemporaryFile& file, std::span<const Value> samples, std::size_t beyond, Value filler) {
    file.write(std::as_bytes(samples));
    constexpr std::size_t kOnce = 4096; // values
    const std::vector<Value> fillers(std::min(beyond, kOnce), filler);
    for (std::size_t rest = beyond; rest > 0; rest -= std::min(rest, kOnce))
        file.write(std::as_bytes(std::span(fillers).first(std::min(rest, kOnce))));
}

} // namespace

PathNpyWriter::PathNpyWriter(const std::filesystem::path& path, std::uint64_t paths, std::uint64_t steps,
                             std::uint32_t channel, Precision precision)
    : file_(path), steps_(steps), channel_(channel) {
    std::vector<std::uint64_t> shape{paths, steps};
    if (components_of(channel) == 3)
        shape.push_back(3);
    file_.write(npy_header(shape, channel, precision));
}

template <typename T> void PathNpyWriter::add(const PathRows<T>& rows) {
    const std::size_t components = components_of(channel_);
    for (std::size_t path = 0; path < rows.path_count; ++path) {
        const std::size_t first = path * rows.pitch * components, samples = rows.samples(path) * components;
        const std::size_t beyond = rows.ends(path) ? (steps_ - rows.steps[path]) * components : 0;
        if (channel_ == layout::kChannelFacet)
            write_row(file_, rows.facet.subspan(first, samples), beyond, layout::kNoFacet);
        else
            write_row(file_, values_of(rows, channel_).subspan(first, samples), beyond,
                      std::numeric_limits<T>::quiet_NaN());
    }
}

VolumeResult PathNpyWriter::finish() {
    return publish_raw(file_);
}

namespace {

template <typename T> void append(std::string& text, T value) {
    char digits[40]; // the shortest form of a double has 24 at most
    text.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
}

} // namespace

const char* path_summary_header() {
    return "path,steps,contact_time_s,largest_force_N,rms_force_N,largest_turn_deg,steepest_turn_deg_per_mm,work_J,"
           "effort_J,eta,rounds,least_round_work_J,mean_round_work_J,largest_round_work_J,least_depth_m,mean_depth_m,"
           "largest_depth_m,depth_deviation_m,"
           "unstable,unstable_time_s,fell,speed_ratio,began_inside,unfinished_samples\n";
}

PathSummary::PathSummary(const std::filesystem::path& path, Precision precision)
    : file_(path), precision_(precision), text_(path_summary_header()) {}

// What follows from floats has no more digits than they.
void PathSummary::number(double value) {
    text_ += ',';
    if (precision_ == Precision::f32)
        append(text_, static_cast<float>(value));
    else
        append(text_, value);
}

void PathSummary::number(const std::optional<double>& value) {
    if (value)
        number(*value);
    else
        text_ += ',';
}

// A point of time is that of a sample, in double as it stands beside samples.
void PathSummary::time(const std::optional<double>& value) {
    text_ += ',';
    if (value)
        append(text_, *value);
}

void PathSummary::whole(std::uint64_t value) {
    text_ += ',';
    append(text_, value);
}

void PathSummary::add(std::uint64_t path, const PathFigures& figures) {
    append(text_, path);
    whole(figures.steps);
    for (const double value : {figures.contact_time, figures.largest_force, figures.rms_force, figures.largest_turn,
                               figures.steepest_turn, figures.work, figures.effort})
        number(value);
    number(figures.eta);
    whole(figures.rounds);
    for (const auto& work : {figures.least_round, figures.mean_round, figures.largest_round})
        number(work);
    for (const auto& depth : {figures.least_depth, figures.mean_depth, figures.largest_depth, figures.depth_deviation})
        number(depth);
    whole(figures.unstable_time ? 1 : 0);
    time(figures.unstable_time);
    whole(figures.fell ? 1 : 0);
    number(figures.speed_ratio);
    whole(figures.began_inside ? 1 : 0);
    whole(figures.unfinished);
    text_ += '\n';
    if (text_.size() < kText)
        return;
    file_.write(text_);
    text_.clear();
}

VolumeResult PathSummary::finish() {
    file_.write(text_);
    text_.clear();
    return publish_raw(file_);
}

} // namespace forceshade
