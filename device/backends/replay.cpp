#include "device/backends/devices.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "host/field/prepared_case.h"
#include "host/paths/path_reader.h"

namespace forceshade::device {

namespace {

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

} // namespace forceshade::device
