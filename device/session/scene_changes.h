// The scene's file while the loop runs: each time it is saved it becomes a new law.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "device/loop/live_loop.h"
#include "device/run_report/report.h"
#include "host/field/prepared_case.h"

namespace forceshade::device {

class SceneChanges {
public:
    /// `read` makes a case of the file, and throws its errors. `first`: the case of the start. `stem`:
    /// scenes are kept as STEM.scene-N.toml, N the path that they begin, or nowhere if it is empty. `has_hand`: the
    /// first scene's hand moves the probe, and stays.
    SceneChanges(const std::filesystem::path& file, const std::function<PreparedCase()>& read,
                 const PreparedCase& first, std::filesystem::path stem, bool has_hand);

    /// Writes the scene of the start. \throws IoError.
    void keep_first() const { keep(used_.front()); }

    struct Message {
        std::string text;
        bool refused = false;
        std::optional<PreparedCase> used; // that the loop uses from now on
    };

    /// Checks the file now and then, hands a change over to the loop and keeps it; returns a message for the user, if
    /// any.
    std::optional<Message> look(LiveLoop& loop);

    /// Scenes that the loop has used, the first included.
    const std::vector<UsedScene>& used() const noexcept { return used_; }

private:
    using Stamp = std::pair<std::filesystem::file_time_type, std::uintmax_t>; // when it was written, its size

    Stamp stamp() const;
    PreparedCase read_again() const;
    std::string keep(const UsedScene& scene) const;

    const std::filesystem::path file_, stem_;
    const std::function<PreparedCase()> read_;
    const Scene first_;
    const bool has_hand_;
    Stamp last_, asked_; // of the last read, of the last check
    int looks_ = 0;
    std::vector<UsedScene> used_;
};

} // namespace forceshade::device
