// What a path was like, in numbers that people read, and what is left of paths: CSV, NPY, VTP, and what a picture
// shows.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "host/output/files.h"
#include "host/output/raw_formats.h"
#include "host/output/rows.h"
#include "host/picture/picture.h"
#include "host/reference/chunks.h"
#include "host/reference/contact.h"
#include "host/scene/scene.h"
#include "shaders/shared/law.h"

namespace forceshade {

/// How long a recorded path is in contact, by the times that the file gives the samples: a sample counts the time until
/// the next one, the last one as much as the one before it. A path of one sample has no time.
class ContactTime {
public:
    /// The next sample, at `time`, s.
    void add(double time, bool touches) {
        if (begun_) {
            share_ = time - time_;
            total_ += touched_ ? share_ : 0;
        }
        begun_ = true;
        time_ = time;
        touched_ = touches;
    }
    /// s.
    double total() const { return total_ + (touched_ ? share_ : 0); }

private:
    bool begun_ = false, touched_ = false;
    double time_ = 0;  /* s: of the last sample */
    double share_ = 0; /* s: of the sample before the last */
    double total_ = 0; /* s: of the samples before the last */
};

/// Empty where a number has no meaning: depths without contact, a speed ratio in open loop. The deviation of depths
/// is a difference of sums: in single precision it is known to about 3e-4 of the mean depth.
struct PathFigures {
    std::uint64_t steps = 0;
    double contact_time = 0;                 /* s: of recorded paths as ContactTime says */
    double largest_force = 0, rms_force = 0; /* N; over the samples before a path left its bound */
    double largest_turn = 0;                 /* deg: of the force between two samples in a row, both in contact */
    double steepest_turn = 0;                /* deg/mm: of the force, over distances of a stretch or more */
    double work = 0;                         /* J: done on the hand */
    double effort = 0;                       /* J: sum of |F . dx| */
    std::optional<double> eta;               /* 1: work / effort */
    std::uint64_t rounds = 0;                /* complete ones */
    std::optional<double> least_round, mean_round, largest_round; /* J: done on the hand in a complete round */
    std::optional<double> least_depth, mean_depth, largest_depth, depth_deviation; /* m: in contact */
    std::optional<double> unstable_time; /* s: t of the sample at which the probe left its bound */
    bool fell = false;                 /* left contact in the direction of the hand's push: off the rim of a surface */
    std::optional<double> speed_ratio; /* 1: largest speed of the last quarter over that of the second */
    bool began_inside = false;
    std::uint64_t unfinished = 0; /* samples at which the proxy did not come to rest */
};

/// Of a path whose samples come at times of their own.
struct PathTimes {
    double contact = 0;  /* s: in contact, as ContactTime counts it */
    double unstable = 0; /* s: t of the sample at which the probe left its bound, if it did */
};

/// What a path's metrics do not say of it.
struct PathFacts {
    std::uint64_t steps = 0; /* samples of the path */
    double rate = 1;         /* 1/s: samples a second */
    bool closed = false;
    bool began_inside = false;
    std::optional<PathTimes> times{}; /* of a recorded path; else samples come at the rate, the first at 0 s */
};

template <typename T> PathFigures figures_of(const layout::PathMetrics<T>& metrics, const PathFacts& facts);

// STEM.paths.csv: a row for each path, what it was like.

/// A number that has the precision of times, which is double whatever the run's.
struct SampleTime {
    std::optional<double> seconds;
};
/// The columns of STEM.paths.csv: hands a path's figures to add(name, value), whole numbers as std::uint64_t, others as
/// optional double or SampleTime.
template <typename Add> void for_each_figure(std::uint64_t path, const PathFigures& figures, const Add& add) {
    using Real = std::optional<double>;
    add("path", path);
    add("steps", figures.steps);
    add("contact_time_s", Real(figures.contact_time));
    add("largest_force_N", Real(figures.largest_force));
    add("rms_force_N", Real(figures.rms_force));
    add("largest_turn_deg", Real(figures.largest_turn));
    add("steepest_turn_deg_per_mm", Real(figures.steepest_turn));
    add("work_J", Real(figures.work));
    add("effort_J", Real(figures.effort));
    add("eta", figures.eta);
    add("rounds", figures.rounds);
    add("least_round_work_J", figures.least_round);
    add("mean_round_work_J", figures.mean_round);
    add("largest_round_work_J", figures.largest_round);
    add("least_depth_m", figures.least_depth);
    add("mean_depth_m", figures.mean_depth);
    add("largest_depth_m", figures.largest_depth);
    add("depth_deviation_m", figures.depth_deviation);
    add("unstable", std::uint64_t(figures.unstable_time ? 1 : 0));
    add("unstable_time_s", SampleTime{figures.unstable_time});
    add("fell", std::uint64_t(figures.fell ? 1 : 0));
    add("speed_ratio", figures.speed_ratio);
    add("began_inside", std::uint64_t(figures.began_inside ? 1 : 0));
    add("unfinished_samples", figures.unfinished);
}

/// Puts the text of std::to_chars, at most 25 characters, in about half of its time; returns its end. By Dragonbox
/// (Jeon 2020). `to` needs room for 40.
template <typename T> char* put_shortest(char* to, T value);
extern template char* put_shortest(char*, float);
extern template char* put_shortest(char*, double);

/// A number as it was written last, with its comma: to copy it takes a tenth of the time that writing it again does.
struct NumberText {
    std::uint64_t bits = 0;
    std::size_t at = 0;    /* in the rows */
    std::uint8_t size = 0; /* of the text; 0: none yet */
    bool kept = false;     /* here, too, since it came again */
    std::array<char, 32> text{};
};

/// Rows of a CSV file of numbers, each the shortest that reads back as the same number.
class NumberRows {
public:
    template <typename T> void add(T value) {
        char *const begin = room(), *end = nullptr;
        if constexpr (std::is_floating_point_v<T>)
            end = put_shortest(begin, value);
        else
            end = std::to_chars(begin, begin + kMost, value).ptr;
        *end = ',';
        size_ += static_cast<std::size_t>(end + 1 - begin);
    }
    /// The same, sooner if it is what `last` or `other` hold: numbers of the same type. `last` then holds it, unless
    /// `other` does.
    template <typename T> void add(T value, NumberText& last, NumberText* other = nullptr) {
        const std::uint64_t bits = bits_of(value);
        char* const begin = room();
        for (NumberText* const known : {&last, other})
            if (known && known->size > 0 && known->bits == bits) {
                keep(*known);
                std::memcpy(begin, known->text.data(), known->text.size());
                size_ += known->size;
                return;
            }
        const std::size_t before = size_;
        add(value);
        last.bits = bits;
        last.at = before;
        last.size = static_cast<std::uint8_t>(size_ - before);
        last.kept = false;
    }
    /// Reads a text that will be asked for after write(). One that was written just now is better read later.
    void keep(NumberText& last) const {
        if (!last.kept)
            std::memcpy(last.text.data(), text_.data() + last.at, last.text.size());
        last.kept = true;
    }
    void add_empty() {
        text_.resize(std::max(text_.size(), size_ + 1));
        text_[size_++] = ',';
    }
    template <typename T> void add(const std::optional<T>& value) { value ? add(*value) : add_empty(); }
    void end_row() { text_[size_ - 1] = '\n'; } // in place of the last comma
    std::size_t size() const { return size_; }  /* bytes that write() would write */
    /// Writes what it holds, and begins anew.
    void write(TemporaryFile& file) {
        file.write(std::string_view(text_).substr(0, size_));
        size_ = 0;
    }

private:
    static constexpr std::size_t kMost = 40; // the shortest form of a double has 24 at most

    template <typename T> static std::uint64_t bits_of(T value) {
        if constexpr (std::is_same_v<T, float>)
            return std::bit_cast<std::uint32_t>(value);
        else if constexpr (std::is_same_v<T, double>)
            return std::bit_cast<std::uint64_t>(value);
        else
            return static_cast<std::uint64_t>(value);
    }
    char* room() {
        if (text_.size() - size_ <= kMost)
            text_.resize(2 * text_.size() + 2 * kMost);
        return text_.data() + size_;
    }

    std::string text_;
    std::size_t size_ = 0; /* bytes of the text in use */
};

/// What the rows of samples so far hold that comes again: many columns stay as they are for a while, a proxy is above
/// its probe, and every path has the times of the one before.
struct SampleTexts {
    std::array<NumberText, 12> columns;
    std::vector<NumberText> times = std::vector<NumberText>(4096); // of steps, in turn

    /// For rows that begin anew.
    void forget_rows() {
        for (NumberText& column : columns)
            column.size = column.kept ? column.size : 0;
    }
};

/// Columns carry their unit in their name; a cell is empty where a number has no meaning.
class PathSummary {
public:
    /// `precision` of the run. \throws IoError, as do the others.
    PathSummary(const std::filesystem::path& path, Precision precision);
    void add(std::uint64_t path, const PathFigures& figures);
    /// Publishes.
    VolumeResult finish();

private:
    TemporaryFile file_;
    Precision precision_;
    NumberRows row_;
};

/// The file's header line.
std::string path_summary_header();

// Explored paths as a CSV file: where the probe was, and the contact there.

/// What a sample of the rows that are being written is called by. Any thread may ask.
struct PathLabels {
    std::function<std::uint64_t(std::uint64_t path)> id;
    std::function<double(std::uint64_t path, std::uint64_t step)> time; /* s */
};

/// Columns path,t,x,y,z,gx,gy,gz,fx,fy,fz,depth,facet (s, m, N), path after path; x, y, z are where the law was
/// evaluated, g is the proxy, both in the world; facet -1 out of contact. Needs all five channels.
class PathCsvWriter final : public PathSink {
public:
    /// `origin`, m, in the world: what places are measured from; on axes on which it is not 0 they are written as
    /// doubles. `compared`: with columns angle (deg) and magnitude_error (N) of [compare], empty where there is no
    /// number. \throws IoError, as do the others.
    PathCsvWriter(const std::filesystem::path& path, const PathLabels& labels, const glm::dvec3& origin = glm::dvec3(0),
                  bool compared = false);
    void write(const AnyPathRows& rows) override;
    VolumeResult finish() override { return publish_raw(file_); }

private:
    static constexpr std::size_t kBuffers = 8; // 4 MiB: the disk has work while samples are computed

    TemporaryFile file_;
    glm::dvec3 origin_; /* m */
    PathLabels labels_;
    std::vector<std::size_t> ends_;  // of the rows' paths, in samples
    std::vector<NumberRows> blocks_; // written by the crew
    std::vector<SampleTexts> texts_; // of its threads
    reference::Crew crew_{most_threads()};
};

// One channel of explored paths as a NumPy array, shape (paths, steps, 3) for vectors and (paths, steps) for scalars.

/// Reals as '<f4' or '<f8', facets as '<u4'; behind a path's end NaN and layout::kNoFacet. Places whose origin is not 0
/// as '<f8' of the world.
class PathNpyWriter final : public PathSink {
public:
    /// `channel` is one layout::kChannel... bit. Throws IoError, as do the others.
    PathNpyWriter(const std::filesystem::path& path, std::uint64_t paths, std::uint64_t steps, std::uint32_t channel,
                  Precision precision, const glm::dvec3& origin = glm::dvec3(0));
    void write(const AnyPathRows& rows) override;
    VolumeResult finish() override { return publish_raw(file_); }

private:
    TemporaryFile file_;
    std::uint64_t steps_;
    std::uint32_t channel_;
    glm::dvec3 origin_; /* m */
};

/// When the samples were, s, as '<f8'.
class PathTimesWriter final : public PathSink {
public:
    /// `paths` with times of their own: shape (paths, steps), NaN behind a path's end; 0: shape (steps), for all paths.
    /// Throws IoError, as do the others.
    PathTimesWriter(const std::filesystem::path& path, std::uint64_t paths, std::uint64_t steps,
                    const PathLabels& labels);
    void write(const AnyPathRows& rows) override;
    VolumeResult finish() override { return publish_raw(file_); }

private:
    TemporaryFile file_;
    std::uint64_t paths_, steps_;
    PathLabels labels_;
    std::vector<double> times_; /* s: of the rows of a path */
};

// Explored paths as polylines for ParaView (.vtp), one a path, streamed.

struct PathVtpHeader {
    std::uint64_t paths = 0, samples = 0; /* samples of all paths, up to their ends */
    bool proxies = false;                 /* whether they are stored */
    Precision precision = Precision::f32; /* Float32 or Float64; of `time` always Float64 */
    bool compared = false;                /* with angle and magnitude_error */
    glm::dvec3 origin{0}; /* m, in the world: what places are measured from; where it is not 0 they are Float64 */
};

/// Points are the probe (m), in the order of the steps. They have `force` (N, the active vector), `depth` (m), `facet`
/// (-1 out of contact), `time` (s) and, where they are stored, `proxy` (m), `angle` (deg) and
/// `magnitude_error` (N); a line has `path`, its number. Needs the
/// channels of what it writes.
class PathVtpWriter final : public PathSink {
public:
    /// Throws IoError, as do the others.
    PathVtpWriter(const std::filesystem::path& path, const PathVtpHeader& header, const PathLabels& labels);
    void write(const AnyPathRows& rows) override;
    VolumeResult finish() override { return file_.finish(); }

private:
    template <typename T> void write_path(const PathRows<T>& rows, std::size_t path);

    VtkFile file_;
    PathLabels labels_;
    PathVtpHeader header_;
    std::int64_t samples_ = 0;        // so far
    std::vector<std::int64_t> order_; // of the samples of one row: room, as is the next
    std::vector<double> times_;       // s
};

// Keeps of explored paths what a picture shows, however many and long they are: a handful of them, evenly chosen, and
// samples of all.

class PathCollector {
public:
    /// `origin`, m, in the world: what places are measured from.
    PathCollector(std::uint64_t paths, std::uint64_t steps, const glm::dvec3& origin = glm::dvec3(0));

    template <typename T> void add(const PathRows<T>& rows);

    const std::vector<picture::DrawnPath>& paths() const { return paths_; }
    /// m: the x between which the paths kept are drawn (`picture::drawn_breadth`), and their mean y.
    struct Reach {
        double from = 0, to = 0, y = 0;
    };
    Reach reach() const;
    /// Of all paths along their breadth; empty where every path is kept.
    std::vector<picture::PathBand> bands() const;
    /// The picture of them.
    picture::Picture draw(const picture::Look& look, const picture::SurfaceLines& surface) const;

private:
    struct Sample {
        double x, z, direction; /* m, deg: NaN without force */
    };
    template <typename T> void add_path(const PathRows<T>& rows, std::size_t path);
    /// Use(sample, at) for every stride-th sample of a path in these rows; `at`: its place in them.
    template <typename T, typename Use>
    void each_sample(const PathRows<T>& rows, std::size_t path, std::uint64_t stride, const Use& use) const;

    std::uint64_t count_, every_, stride_, every_of_all_, stride_of_all_;
    glm::dvec3 origin_; /* m */
    std::vector<picture::DrawnPath> paths_;
    std::vector<Sample> all_; // empty where every path is drawn
    double y_sum_ = 0;
    std::uint64_t y_samples_ = 0;
};

/// How paths in contact follow a line: it is sunk by their mean distance from it, then they are compared.
struct Following {
    std::uint64_t samples = 0; /* in contact, over the line */
    double sunk = 0;           /* m: mean distance below the line, along z */
    double distance = 0;       /* m: root mean square from the line so sunk, along z */
    double angle = 0;          /* deg: root mean square between the force and the line's normal */
    double median_angle = 0;   /* deg: the median, which an edge that the probe rattles on does not change */
};

/// Of a line whose x increases; no samples where the line is missing.
Following following(const std::vector<picture::DrawnPath>& paths, const std::vector<picture::LinePoint>& line);

} // namespace forceshade
