// The scene's file while the loop runs: saved anew, it becomes a new law.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "device/law/live_law.h"
#include "host/field/prepared_case.h"

namespace forceshade::device {

class SceneWatch {
public:
    /// `read` makes a case of the file, and throws what is wrong with it. `first`: the scene of the start.
    SceneWatch(std::filesystem::path file, std::function<PreparedCase()> read, const Scene& first);

    /// What became of a change of the file.
    struct Change {
        std::unique_ptr<LiveLaw> law; // null: refused
        std::string scene;            // resolved TOML
        bool moves_otherwise = false; // [paths] or [hand] differ from those of the start
        std::string refusal;          // why
    };

    /// Whether the file has changed since the last look, and no more since the last question: an editor may empty it
    /// before it writes. Then a look at it.
    bool has_changed();
    Change look();

private:
    struct Stamp {
        std::filesystem::file_time_type time{};
        std::uintmax_t size = 0;
        friend bool operator==(const Stamp&, const Stamp&) = default;
    };
    Stamp stamp() const;

    std::filesystem::path file_;
    std::function<PreparedCase()> read_;
    const Scene first_;
    Stamp last_, asked_;
};

} // namespace forceshade::device
