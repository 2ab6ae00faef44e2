#include "host/path_output/path_summary.h"

#include <charconv>

#include "host/io/raw_rows.h"

namespace forceshade {
namespace {

constexpr std::size_t kText = std::size_t(1) << 18; // bytes gathered before they are written

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
