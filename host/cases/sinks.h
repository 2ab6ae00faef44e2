// The files that the rows of a case go to.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "host/output/record.h"
#include "host/output/rows.h"
#include "host/program.h"

namespace forceshade {

/// A published file.
template <typename Record> void add_file(Record& record, const std::string& name, const VolumeResult& result) {
    record.files.push_back({name, result.sha256, result.bytes});
    record.volume_times += result.timings;
}

/// ChunkSinks or PathSinks: written together and published in their order.
template <typename Sink> class Sinks {
public:
    void add(const std::filesystem::path& file, std::unique_ptr<Sink> sink) {
        sinks_.emplace_back(file.filename().string(), std::move(sink));
    }

    /// What a sink takes. \throws what the sinks throw, Interrupted.
    template <typename... Rows> void write(const Rows&... rows) {
        for (const auto& [name, sink] : sinks_) {
            check_interrupt();
            sink->write(rows...);
        }
    }

    /// Publishes the first, which refuses what must not be published, and adds it to a CaseRecord or PathRecord.
    template <typename Record> VolumeResult finish_first(Record& record) { return finish(sinks_.front(), record); }
    /// Then the others.
    template <typename Record> void finish_others(Record& record) {
        for (std::size_t i = 1; i < sinks_.size(); ++i)
            finish(sinks_[i], record);
    }

private:
    using Named = std::pair<std::string, std::unique_ptr<Sink>>;

    template <typename Record> static VolumeResult finish(Named& one, Record& record) {
        VolumeResult result = one.second->finish();
        add_file(record, one.first, result);
        return result;
    }

    std::vector<Named> sinks_;
};

} // namespace forceshade
