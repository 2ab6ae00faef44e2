#include "host/paths/path_files.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <type_traits>

#include <fmt/format.h>

#include "host/numbers.h"
#include "host/output/raw_formats.h"

namespace forceshade {

namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

// A sum whose second term keeps what rounding took from the first.
template <typename T> double whole(T sum, T rest) {
    return double(sum) - double(rest);
}

// From the square of the chord between two unit vectors.
double angle_of(double square) {
    return 2 * std::asin(std::min(std::sqrt(square) / 2, 1.0)) * kDegrees;
}

template <typename T> void add_depths(PathFigures& figures, const layout::PathMetrics<T>& metrics) {
    if (metrics.contact_samples == 0)
        return;
    const double samples = metrics.contact_samples;
    const double deeper = whole(metrics.depth, metrics.depth_rest) / samples;
    const double square = whole(metrics.depth_square, metrics.depth_square_rest) / samples;
    figures.least_depth = double(metrics.least_depth);
    figures.mean_depth = double(metrics.first_depth) + deeper;
    figures.largest_depth = double(metrics.largest_depth);
    figures.depth_deviation = std::sqrt(std::max(square - deeper * deeper, 0.0));
}

// All rounds together have done the work up to where the next one began.
template <typename T> void add_rounds(PathFigures& figures, const layout::PathMetrics<T>& metrics) {
    figures.rounds = metrics.rounds;
    if (metrics.rounds == 0)
        return;
    figures.least_round = double(metrics.least_round);
    figures.mean_round = whole(metrics.round_begin, metrics.round_begin_rest) / double(metrics.rounds);
    figures.largest_round = double(metrics.largest_round);
}

} // namespace

template <typename T> PathFigures figures_of(const layout::PathMetrics<T>& metrics, const PathFacts& facts) {
    constexpr double kMillimetres = 1000; // in a metre
    const bool unstable = metrics.unstable_step != layout::kNever;
    const std::uint64_t samples = unstable ? metrics.unstable_step : facts.steps;
    PathFigures figures;
    figures.steps = facts.steps;
    figures.contact_time = facts.times ? facts.times->contact : double(metrics.contact_samples) / facts.rate;
    figures.largest_force = double(metrics.largest_force);
    if (samples > 0)
        figures.rms_force =
            std::sqrt(std::max(whole(metrics.force_square, metrics.force_square_rest), 0.0) / double(samples));
    figures.largest_turn = angle_of(double(metrics.largest_turn));
    figures.steepest_turn =
        angle_of(double(metrics.steepest_turn)) / (std::sqrt(double(metrics.steepest_distance)) * kMillimetres);
    figures.work = whole(metrics.work, metrics.work_rest);
    figures.effort = whole(metrics.effort, metrics.effort_rest);
    if (figures.effort > 0)
        figures.eta = figures.work / figures.effort;
    add_rounds(figures, metrics);
    add_depths(figures, metrics);
    if (unstable)
        figures.unstable_time = facts.times ? facts.times->unstable : double(metrics.unstable_step) / facts.rate;
    figures.fell = metrics.fell != 0;
    if (facts.closed && metrics.early_speed > 0)
        figures.speed_ratio = double(metrics.late_speed) / double(metrics.early_speed);
    figures.began_inside = facts.began_inside;
    figures.unfinished = metrics.unfinished;
    return figures;
}

template PathFigures figures_of<float>(const layout::PathMetrics<float>&, const PathFacts&);
template PathFigures figures_of<double>(const layout::PathMetrics<double>&, const PathFacts&);

// Beyond these sizes an exponent may be shorter, and integers are exact.
template <typename T> char* put_shortest(char* to, T value) {
    constexpr std::ptrdiff_t kRoom = 40;
    const T size = std::abs(value);
    if (!(size >= T(1e-3) && size < T(1e5)))
        return std::to_chars(to, to + kRoom, value).ptr;
    const auto [digits, power] = fmt::detail::dragonbox::to_decimal(size);
    const int count = fmt::detail::count_digits(digits), whole = count + power; // places before the point
    *to = '-';
    to += std::signbit(value);
    std::copy_n("0.00", 4, to);
    char* const begin = whole <= 0 ? to + 2 - whole : power < 0 ? to + 1 : to;
    fmt::detail::format_decimal(begin, digits, count);
    if (power >= 0)
        return std::fill_n(begin + count, power, '0');
    for (int i = 0; i < whole; ++i, ++to)
        to[0] = to[1];
    if (whole > 0)
        *to = '.';
    return begin + count;
}
template char* put_shortest(char*, float);
template char* put_shortest(char*, double);

std::string path_summary_header() {
    std::string names;
    for_each_figure(0, {}, [&](std::string_view name, const auto&) { names.append(name) += ','; });
    names.back() = '\n';
    return names;
}

PathSummary::PathSummary(const std::filesystem::path& path, Precision precision)
    : file_(path, true), precision_(precision) {
    file_.write(path_summary_header());
}

void PathSummary::add(std::uint64_t path, const PathFigures& figures) {
    for_each_figure(path, figures, [&]<typename Value>(const char*, const Value& value) {
        if constexpr (std::is_same_v<Value, SampleTime>)
            row_.add(value.seconds);
        else if constexpr (std::is_same_v<Value, std::optional<double>>) {
            if (value && precision_ == Precision::f32)
                row_.add(static_cast<float>(*value)); // what follows from floats has no more digits than they
            else
                row_.add(value);
        } else
            row_.add(value);
    });
    row_.end_row();
    row_.write(file_);
}

VolumeResult PathSummary::finish() {
    return publish_raw(file_);
}

PathCsvWriter::PathCsvWriter(const std::filesystem::path& path, const PathLabels& labels, const glm::dvec3& origin,
                             bool compared)
    : file_(path, true, kBuffers), origin_(origin), labels_(labels), blocks_(32 * most_threads()),
      texts_(most_threads()) {
    file_.write(
        fmt::format("path,t,x,y,z,gx,gy,gz,fx,fy,fz,depth,facet{}\n", compared ? ",angle,magnitude_error" : ""));
}

namespace {

/// A sample, places in m from the origin; `compared`: the two columns of [compare], or none.
template <typename T>
void add_sample(NumberRows& row, SampleTexts& texts, NumberText& time_text, const glm::dvec3& origin,
                std::uint64_t path, double time, const reference::Vector<T>& probe,
                const reference::Contact<T>& contact, std::span<const T> compared) {
    NumberText* text = texts.columns.data();
    row.add(path, *text++);
    row.add(time, time_text);
    row.keep(time_text);
    for (int i = 0; i < 6; ++i, ++text) {
        const int axis = i % 3;
        const T place = i < 3 ? probe[axis] : contact.proxy[axis];
        NumberText* const of_probe = i < 3 ? nullptr : text - 3;
        origin[axis] != 0 ? row.add(origin[axis] + double(place), *text, of_probe) : row.add(place, *text, of_probe);
    }
    for (const T component : {contact.force.x, contact.force.y, contact.force.z, contact.depth})
        row.add(component, *text++);
    if (contact.facet == layout::kNoFacet)
        row.add(-1, *text);
    else
        row.add(contact.facet, *text);
    for (const T number : compared)
        std::isnan(number) ? row.add_empty() : row.add(number);
    row.end_row();
}

/// Samples of rows, counted path after path, from `first` to before `last`; `ends` of the paths.
template <typename T>
void add_samples(NumberRows& text, SampleTexts& texts, const PathLabels& labels, const glm::dvec3& origin,
                 const PathRows<T>& rows, const std::vector<std::size_t>& ends, std::size_t first, std::size_t last) {
    texts.forget_rows();
    auto row = static_cast<std::size_t>(std::ranges::upper_bound(ends, first) - ends.begin());
    for (std::size_t sample = first; sample < last; ++row) {
        const std::uint64_t path = rows.path_first + row, id = labels.id(path);
        const std::size_t begin = row > 0 ? ends[row - 1] : 0;
        for (; sample < std::min(last, ends[row]); ++sample) {
            const std::size_t at = row * rows.pitch + sample - begin, step = rows.step_first + sample - begin;
            const reference::Contact<T> contact{rows.depth[at],
                                                reference::vector_at(rows.force, at),
                                                {},
                                                reference::vector_at(rows.proxy, at),
                                                rows.facet[at]};
            std::array<T, 2> compared{};
            if (!rows.angle.empty())
                compared = {rows.angle[at], rows.magnitude_error[at]};
            add_sample<T>(text, texts, texts.times[step % texts.times.size()], origin, id, labels.time(path, step),
                          reference::vector_at(rows.position, at), contact,
                          std::span(compared).first(rows.angle.empty() ? 0 : compared.size()));
        }
    }
}

} // namespace

void PathCsvWriter::write(const AnyPathRows& any) {
    constexpr std::size_t kBlock = 1024; // samples
    const std::size_t at_once = blocks_.size() * kBlock;
    const auto add = [&]<typename T>(const PathRows<T>& rows) {
        ends_.clear();
        for (std::size_t row = 0; row < rows.path_count; ++row)
            ends_.push_back((row > 0 ? ends_.back() : 0) + rows.samples(row));
        const std::size_t all = ends_.empty() ? 0 : ends_.back();
        for (std::size_t done = 0; done < all; done += at_once) {
            const std::size_t end = std::min(done + at_once, all);
            std::vector<std::atomic<bool>> ready(blocks_.size());
            std::size_t written = 0; // blocks
            const auto write_ready = [&] {
                for (; written < ready.size() && ready[written]; ++written)
                    blocks_[written].write(file_);
            };
            crew_.share_out((end - done + kBlock - 1) / kBlock, [&](std::size_t thread, std::size_t block) {
                const std::size_t first = done + block * kBlock;
                add_samples(blocks_[block], texts_[thread], labels_, origin_, rows, ends_, first,
                            std::min(first + kBlock, end));
                ready[block] = true;
                if (thread == 0) // which may throw
                    write_ready();
            });
            write_ready();
        }
    };
    std::visit(add, any);
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
                             std::uint32_t channel, Precision precision, const glm::dvec3& origin)
    : file_(path, true), steps_(steps), channel_(channel), origin_(origin) {
    file_.write(npy_header({paths, steps}, channel, precision, origin));
}

void PathNpyWriter::write(const AnyPathRows& any) {
    std::visit(
        [&]<typename T>(const PathRows<T>& rows) {
            const std::size_t components = components_of(channel_);
            for (std::size_t path = 0; path < rows.path_count; ++path) {
                const std::size_t first = path * rows.pitch * components, samples = rows.samples(path) * components;
                const std::size_t beyond = rows.ends(path) ? (steps_ - rows.steps[path]) * components : 0;
                if (channel_ == layout::kChannelFacet)
                    write_row(file_, rows.facet.subspan(first, samples), beyond, layout::kNoFacet);
                else if (const std::span<const T> values = values_of(rows, channel_).subspan(first, samples);
                         is_moved(channel_, origin_))
                    write_row(file_, std::span<const double>(in_world(values, origin_)), beyond,
                              std::numeric_limits<double>::quiet_NaN());
                else
                    write_row(file_, values, beyond, std::numeric_limits<T>::quiet_NaN());
            }
        },
        any);
}

PathTimesWriter::PathTimesWriter(const std::filesystem::path& path, std::uint64_t paths, std::uint64_t steps,
                                 const PathLabels& labels)
    : file_(path, true), paths_(paths), steps_(steps), labels_(labels) {
    std::vector<std::uint64_t> shape{steps};
    if (paths > 0)
        shape.insert(shape.begin(), paths);
    file_.write(npy_header(shape, layout::kChannelDepth, Precision::f64, glm::dvec3(0))); // one number a sample
}

void PathTimesWriter::write(const AnyPathRows& any) {
    std::visit(
        [&](const auto& rows) {
            for (std::size_t path = 0; path < rows.path_count; ++path) {
                if (paths_ == 0 && rows.path_first + path > 0)
                    return;
                times_.clear();
                for (std::size_t i = 0; i < rows.samples(path); ++i)
                    times_.push_back(labels_.time(rows.path_first + path, rows.step_first + i));
                write_row(file_, std::span<const double>(times_), rows.ends(path) ? steps_ - rows.steps[path] : 0,
                          std::numeric_limits<double>::quiet_NaN());
            }
        },
        any);
}

namespace {

PolyData lines_of(const PathVtpHeader& header) {
    const std::string_view real = header.precision == Precision::f64 ? vtk_type<double>() : vtk_type<float>();
    PolyData data;
    data.polygons = false;
    data.points = data.corners = header.samples;
    data.cells = header.paths;
    const std::string_view place = header.origin != glm::dvec3(0) ? vtk_type<double>() : real;
    data.point_type = place;
    data.point_data = {{"force", real, 3, header.samples},
                       {"depth", real, 1, header.samples},
                       {"facet", vtk_type<std::int32_t>(), 1, header.samples},
                       {"time", vtk_type<double>(), 1, header.samples}};
    if (header.proxies)
        data.point_data.push_back({"proxy", place, 3, header.samples});
    for (const std::uint32_t channel : {kChannelAngle, kChannelMagnitudeError})
        if (header.compared)
            data.point_data.push_back({name_of_channel(channel), real, 1, header.samples});
    data.cell_data = {{"path", vtk_type<std::int64_t>(), 1, header.paths}};
    data.active_points = "Vectors=\"force\" Scalars=\"depth\"";
    data.active_cells = "Scalars=\"path\"";
    return data;
}

} // namespace

PathVtpWriter::PathVtpWriter(const std::filesystem::path& path, const PathVtpHeader& header, const PathLabels& labels)
    : file_(make_vtp(path, lines_of(header))), labels_(labels), header_(header) {}

template <typename T> void PathVtpWriter::write_path(const PathRows<T>& rows, std::size_t path) {
    const std::size_t first = path * rows.pitch, count = rows.samples(path);
    const auto reals = [&](const char* name, std::uint32_t channel) {
        const std::size_t components = components_of(channel);
        const std::span<const T> values = values_of(rows, channel).subspan(first * components, count * components);
        if (is_moved(channel, header_.origin))
            file_.write(name, std::as_bytes(std::span<const double>(in_world(values, header_.origin))));
        else
            file_.write(name, std::as_bytes(values));
    };
    reals("force", layout::kChannelForce);
    reals("depth", layout::kChannelDepth);
    reals("Points", layout::kChannelPosition);
    if (header_.proxies)
        reals("proxy", layout::kChannelProxy);
    for (const std::uint32_t channel : {kChannelAngle, kChannelMagnitudeError})
        if (header_.compared)
            reals(name_of_channel(channel), channel);
    file_.write("facet", std::as_bytes(rows.facet.subspan(first, count))); // what they call no facet is -1
    order_.resize(count);
    std::iota(order_.begin(), order_.end(), samples_);
    file_.write("connectivity", std::as_bytes(std::span(order_)));
    times_.resize(count);
    for (std::size_t i = 0; i < count; ++i)
        times_[i] = labels_.time(rows.path_first + path, rows.step_first + i);
    file_.write("time", std::as_bytes(std::span(times_)));
    samples_ += static_cast<std::int64_t>(count);
    if (!rows.ends(path))
        return;
    const auto id = static_cast<std::int64_t>(labels_.id(rows.path_first + path));
    file_.write("path", std::as_bytes(std::span(&id, 1)));
    file_.write("offsets", std::as_bytes(std::span(&samples_, 1)));
}

void PathVtpWriter::write(const AnyPathRows& any) {
    std::visit(
        [&]<typename T>(const PathRows<T>& rows) {
            for (std::size_t path = 0; path < rows.path_count; ++path)
                write_path(rows, path);
        },
        any);
}

namespace {

constexpr std::uint64_t kDrawn = 5;          // paths
constexpr std::uint64_t kDrawnSteps = 40000; // of each
constexpr std::uint64_t kBandPaths = 20000;  // at most, of which percentiles are
constexpr std::uint64_t kBandSamples = 200000;

struct OnLine {
    double height; /* m */
    double angle;  /* deg: of the normal, from z towards x */
};

// True if a height can be read off the line at every x: no pieces, x increasing.
bool is_graph(const std::vector<picture::LinePoint>& line) {
    for (std::size_t i = 1; i < line.size(); ++i)
        if (!(line[i].x > line[i - 1].x))
            return false;
    return !line.empty();
}

std::optional<OnLine> on_line(const std::vector<picture::LinePoint>& line, double x) {
    const auto after = std::upper_bound(line.begin(), line.end(), x,
                                        [](double at, const picture::LinePoint& point) { return at < point.x; });
    if (after == line.begin() || after == line.end())
        return std::nullopt;
    const picture::LinePoint &from = *(after - 1), &to = *after;
    const double share = (x - from.x) / (to.x - from.x);
    return OnLine{std::lerp(from.z, to.z, share), std::atan2(from.z - to.z, to.x - from.x) * kDegrees};
}

std::string follows(const Following& f, const char* line) {
    return fmt::format("{} from {} sunk by {}, the force {:.2f}° (median {:.2f}°) from its normal",
                       numbers::quantity_text(f.distance, "m"), line, numbers::quantity_text(std::fabs(f.sunk), "m"),
                       f.angle, f.median_angle);
}

} // namespace

PathCollector::PathCollector(std::uint64_t paths, std::uint64_t steps, const glm::dvec3& origin)
    : count_(paths), every_(std::max<std::uint64_t>(1, (paths + kDrawn - 1) / kDrawn)),
      stride_(std::max<std::uint64_t>(1, (steps + kDrawnSteps - 1) / kDrawnSteps)),
      every_of_all_(paths / kBandPaths + 1),
      stride_of_all_(
          steps / std::max<std::uint64_t>(1, kBandSamples / std::clamp<std::uint64_t>(paths, 1, kBandPaths)) + 1),
      origin_(origin) {}

template <typename T> void PathCollector::add(const PathRows<T>& rows) {
    for (std::size_t path = 0; path < rows.path_count; ++path) {
        if ((rows.path_first + path) % every_ == 0)
            add_path(rows, path);
        if (every_ > 1 && (rows.path_first + path) % every_of_all_ == 0)
            each_sample(rows, path, stride_of_all_, [&](const Sample& sample, std::size_t) { all_.push_back(sample); });
    }
}
template void PathCollector::add<float>(const PathRows<float>&);
template void PathCollector::add<double>(const PathRows<double>&);

template <typename T, typename Use>
void PathCollector::each_sample(const PathRows<T>& rows, std::size_t path, std::uint64_t stride, const Use& use) const {
    const std::size_t end = rows.step_first + rows.samples(path);
    for (std::size_t step = (rows.step_first + stride - 1) / stride * stride; step < end; step += stride) {
        const std::size_t at = 3 * (path * rows.pitch + step - rows.step_first);
        const double fx = double(rows.force[at]), fz = double(rows.force[at + 2]);
        use(Sample{origin_.x + double(rows.position[at]), origin_.z + double(rows.position[at + 2]),
                   fx == 0 && fz == 0 ? NAN : std::atan2(fx, fz) * kDegrees},
            at);
    }
}

template <typename T> void PathCollector::add_path(const PathRows<T>& rows, std::size_t path) {
    if (rows.step_first == 0)
        paths_.emplace_back().label = fmt::format("path {}", rows.path_first + path);
    picture::DrawnPath& drawn = paths_.back();
    each_sample(rows, path, stride_, [&](const Sample& sample, std::size_t at) {
        drawn.way.push_back({sample.x, sample.z});
        drawn.direction.push_back(sample.direction);
        y_sum_ += origin_.y + double(rows.position[at + 1]);
        ++y_samples_;
    });
}

std::vector<picture::PathBand> PathCollector::bands() const {
    constexpr std::size_t kBins = 100, kLeast = 20;
    const auto [from, to, y] = reach();
    std::vector<std::array<std::vector<double>, 2>> bins(kBins);
    for (const Sample& sample : all_)
        if (const double share = (sample.x - from) / (to - from); share >= 0 && share <= 1) {
            auto& bin = bins[std::min(kBins - 1, static_cast<std::size_t>(share * double(kBins)))];
            bin[0].push_back(sample.z);
            if (!std::isnan(sample.direction))
                bin[1].push_back(sample.direction);
        }
    const auto percentiles = [](std::vector<double>& values) -> std::array<double, 3> {
        if (values.size() < kLeast)
            return {NAN, NAN, NAN};
        std::ranges::sort(values);
        const auto at = [&](double share) {
            return values[static_cast<std::size_t>(std::lround(share * double(values.size() - 1)))];
        };
        return {at(0.05), at(0.5), at(0.95)};
    };
    std::vector<picture::PathBand> all;
    for (std::size_t i = 0; i < kBins && !all_.empty(); ++i)
        all.push_back(
            {std::lerp(from, to, (double(i) + 0.5) / double(kBins)), percentiles(bins[i][0]), percentiles(bins[i][1])});
    return all;
}

PathCollector::Reach PathCollector::reach() const {
    const picture::Breadth breadth = picture::drawn_breadth(paths_);
    return {breadth.low, breadth.high, y_samples_ ? y_sum_ / double(y_samples_) : 0};
}

picture::Picture PathCollector::draw(const picture::Look& look, const picture::SurfaceLines& surface) const {
    picture::PathDrawing drawing{look, {}, paths_, surface, is_graph(surface.nominal), bands()};
    std::string shown = fmt::format("{} of {} paths", paths_.size(), count_);
    if (stride_ > 1)
        shown += fmt::format(", every {}th sample", stride_);
    drawing.notes.push_back(shown + " over the section of the surface at their mean y; below, the direction of the "
                                    "force in the x-z plane, from z towards x");
    std::string note;
    if (const Following f = following(paths_, surface.nominal); f.samples > 0)
        note = "in contact (root mean square): " + follows(f, "the surface");
    if (const Following f = following(paths_, surface.smooth); f.samples > 0 && !note.empty())
        note += "; " + follows(f, "the shape that the shading imitates");
    if (!note.empty())
        drawing.notes.push_back(note);
    return picture::draw_paths(drawing);
}

Following following(const std::vector<picture::DrawnPath>& paths, const std::vector<picture::LinePoint>& line) {
    Following result;
    if (!is_graph(line))
        return result;
    std::vector<double> below, turns;
    double turned = 0;
    for (const picture::DrawnPath& path : paths)
        for (std::size_t i = 0; i < path.way.size(); ++i) {
            const std::optional<OnLine> nearest = on_line(line, path.way[i].x);
            if (!nearest || std::isnan(path.direction[i]))
                continue;
            below.push_back(nearest->height - path.way[i].z);
            result.sunk += below.back();
            turns.push_back(std::fabs(std::remainder(path.direction[i] - nearest->angle, 360)));
            turned += turns.back() * turns.back();
        }
    result.samples = below.size();
    if (below.empty())
        return result;
    const double samples = double(below.size());
    result.sunk /= samples;
    double square = 0;
    for (const double depth : below)
        square += (depth - result.sunk) * (depth - result.sunk);
    result.distance = std::sqrt(square / samples);
    result.angle = std::sqrt(turned / samples);
    const auto middle = turns.begin() + static_cast<std::ptrdiff_t>(turns.size() / 2);
    std::nth_element(turns.begin(), middle, turns.end());
    result.median_angle = *middle;
    return result;
}

} // namespace forceshade
