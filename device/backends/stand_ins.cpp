// What stands in for a device: a simulated hand that holds a simulated one, and a recording.
#include "device/backends/devices.h"

#include <algorithm>
#include <atomic>
#include <charconv>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "host/field/prepared_case.h"
#include "host/paths/path_reader.h"
#include "host/paths/scene_paths.h"
#include "host/reference/path_step.h"
#include "host/scene/value.h"

namespace forceshade::device {

namespace {

using reference::Vector;

// Paths as the hand follows them: in a closed loop.
PreparedCase with_hand(PreparedCase prepared, double rate) {
    Scene& scene = prepared.one.scene;
    if (!scene.paths) {
        scene.paths.emplace();
        scene.paths->drive = PathDrive::press;
    }
    scene.paths->loop = PathLoop::closed;
    scene.paths->rate = rate;
    scene.precision = Precision::f64; // of the world; the law has its own
    return prepared;
}

class Sim final : public BackEnd {
public:
    Sim(PreparedCase prepared, double rate, std::uint64_t still, std::vector<HeldButton> buttons)
        : prepared_(with_hand(std::move(prepared), rate)), still_(still), origin_(scene_origin(prepared_)),
          paths_(prepared_), input_(paths_.input()), hand_(input_.hands[0]), batch_(paths_.batch(0, 1)),
          buttons_(std::move(buttons)) {
        if (input_.features.motion == layout::kMotionRecorded)
            record();
        begin();
        facts_.name = "simulated hand and device";
        facts_.software = "exact zero-order hold";
        facts_.max_force = hand_.max_force;
        facts_.rate = rate;
        facts_.simulated = true;
        for (const HeldButton& held : buttons_)
            facts_.buttons = std::max(facts_.buttons, held.button);
    }

    const DeviceFacts& facts() const noexcept override { return facts_; }

    Reading read() noexcept override {
        const Vector<double> position(state_.x, state_.y, state_.z), offset = position - target(state_.step);
        const bool left = !(reference::dot(offset, offset) <= hand_.bound * hand_.bound);
        if (left)
            begin();
        const Vector<double> measured = reference::measured(hand_, Vector<double>(state_.x, state_.y, state_.z));
        return {Answer::fresh, world_place(measured, origin_), left,
                pressed(static_cast<double>(samples_++) / facts_.rate)};
    }

    bool write(const glm::dvec3& force) noexcept override {
        if (waits_ > 0) {
            --waits_;
            return true;
        }
        const Vector<double> displayed(halted_.load(std::memory_order_relaxed) ? glm::dvec3(0) : force);
        const reference::PathSampled<double> sampled{{}, displayed, {}};
        reference::advance_probe(state_, hand_, sampled, target(state_.step), target(state_.step + 1), 0U);
        reference::keep_sample(state_, sampled);
        return true;
    }

    void halt() noexcept override { halted_.store(true, std::memory_order_relaxed); }

private:
    std::uint32_t pressed(double time) const noexcept {
        std::uint32_t all = 0;
        for (const HeldButton& held : buttons_)
            if (time >= held.from && time < held.until)
                all |= button_bit(held.button);
        return all;
    }

    void begin() noexcept {
        state_ = reference::begin_state(input_.features, hand_, target(0));
        waits_ = still_;
    }

    // The file gives positions in windows; the loop wants them without waiting.
    void record() {
        constexpr std::size_t kWindow = std::size_t(1) << 16;
        const std::size_t steps = batch_.steps.front();
        recorded_.reserve(steps);
        for (std::size_t step = 0; step < steps; step += kWindow) {
            const auto window = paths_.positions(step, std::min(kWindow, steps - step));
            for (std::size_t i = 0; i < std::min(kWindow, steps - step); ++i)
                recorded_.push_back(reference::vector_at(window, i));
        }
    }

    Vector<double> target(layout::uint step) const noexcept {
        if (!recorded_.empty())
            return recorded_[std::min<std::size_t>(step, recorded_.size() - 1)];
        return reference::motion_at(input_.law, input_.features, batch_, 0, step);
    }

    const PreparedCase prepared_;
    const std::uint64_t still_;
    std::uint64_t waits_ = 0; // samples for which the hand still holds still
    const glm::dvec3 origin_; /* m, in the world: of the places below */
    ScenePaths<double> paths_;
    const layout::PathInput<double> input_;
    const layout::HandParams<double> hand_;
    const layout::PathBatch<double> batch_; // points into paths_
    std::vector<Vector<double>> recorded_;  /* m; empty: generated */
    layout::PathState<double> state_{};
    const std::vector<HeldButton> buttons_;
    std::uint64_t samples_ = 0; // read
    DeviceFacts facts_;
    std::atomic<bool> halted_ = false;
};

struct Row {
    glm::dvec3 position; /* m */
    std::size_t path;    // numbered by their first rows
};

// The rate of a recording, up to clock error and rounding: samples at 10 kHz may lie 99.9 us apart.
double rounded_rate(double recorded) {
    constexpr double kOff = 0.02;
    for (const double end : {kSlowestRate, kFastestRate})
        if (std::abs(recorded - end) <= kOff * end)
            return end;
    return recorded;
}

class Replay final : public BackEnd {
public:
    explicit Replay(const std::filesystem::path& file) {
        PathReader reader(file, kLargestLength<double>);
        PathCensus census(reader.csv().source());
        constexpr std::size_t kBatch = 4096;
        std::vector<PathSample> samples;
        double first = 0, last = 0; /* s: of the first path */
        std::uint64_t first_rows = 0;
        for (reader.read(samples, kBatch); !samples.empty(); reader.read(samples, kBatch))
            for (const PathSample& sample : samples) {
                if (rows_.empty())
                    first = sample.time;
                rows_.push_back({sample.probe, census.add(sample)});
                if (rows_.back().path == 0) {
                    last = sample.time;
                    ++first_rows;
                }
            }
        if (census.first_return())
            std::stable_sort(rows_.begin(), rows_.end(), [](const Row& a, const Row& b) { return a.path < b.path; });
        if (last > first)
            facts_.rate = rounded_rate(static_cast<double>(first_rows - 1) / (last - first));
        if (reader.csv().ends_open())
            facts_.remark = location_prefix(reader.csv().source(), reader.csv().end()) +
                            "the last line has no line feed: if the file was cut off, its last number may be too";
        facts_.name = "recording " + file.filename().string();
        facts_.software = "forceshade";
        facts_.simulated = true;
    }

    const DeviceFacts& facts() const noexcept override { return facts_; }

    Reading read() noexcept override {
        if (next_ == rows_.size())
            return {Answer::ended, glm::dvec3(0), false};
        const Row& row = rows_[next_];
        const bool begins = next_ == 0 || row.path != rows_[next_ - 1].path;
        ++next_;
        return {Answer::fresh, row.position, begins};
    }
    bool write(const glm::dvec3&) noexcept override { return true; }
    void halt() noexcept override {}

private:
    std::vector<Row> rows_;
    std::size_t next_ = 0;
    DeviceFacts facts_;
};

} // namespace

std::unique_ptr<BackEnd> make_replay(const std::filesystem::path& file) {
    return std::make_unique<Replay>(file);
}

std::unique_ptr<BackEnd> make_sim(PreparedCase prepared, double rate, std::uint64_t still,
                                  std::vector<HeldButton> buttons) {
    return std::make_unique<Sim>(std::move(prepared), rate, still, std::move(buttons));
}

std::vector<HeldButton> parse_held_buttons(std::string_view text) {
    constexpr std::string_view kBlanks = " ";
    std::vector<HeldButton> buttons;
    while (!text.empty()) {
        const std::string_view item = text.substr(0, text.find(','));
        text.remove_prefix(std::min(text.size(), item.size() + 1));
        const std::size_t at = item.find('@'), dots = item.find("..");
        const std::size_t begin = std::min(item.find_first_not_of(kBlanks), item.size());
        HeldButton held;
        const char* const end = item.data() + std::min(at, item.size());
        const auto read = std::from_chars(item.data() + begin, end, held.button);
        if (at == std::string_view::npos || dots == std::string_view::npos || dots < at || read.ec != std::errc() ||
            read.ptr != end || held.button < 1 || held.button > 32)
            throw UsageError("--device sim:{}: a button from 1 to 32 and the time for which the hand holds "
                             "it, as in sim:1@0.5 s..3 s,2@1 s..1.2 s",
                             item);
        held.from = parse_quantity(item.substr(at + 1, dots - at - 1), Dimension::time);
        held.until = parse_quantity(item.substr(dots + 2), Dimension::time);
        buttons.push_back(held);
    }
    return buttons;
}

} // namespace forceshade::device
