// The scene's file while the loop runs: saved anew, it becomes a new law.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "device/loop/live_law.h"
#include "device/loop/live_loop.h"
#include "host/prepare/prepared_case.h"

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

// What becomes of a scene that is saved while the loop runs.

class SceneChanges {
public:
    /// `first`: the case of the start; `beside`: scenes are kept as BESIDE.scene-N.toml, N the
    /// path that they begin, or nowhere if it is empty; `has_hand`: the first scene's hand moves the probe, and stays.
    SceneChanges(const std::filesystem::path& scene, const std::function<PreparedCase()>& read,
                 const PreparedCase& first, std::filesystem::path beside, bool has_hand)
        : watch_(scene, read, first.one.scene), name_(scene.filename().string()), beside_(std::move(beside)),
          has_hand_(has_hand) {
        take(0, first.scene);
    }

    struct Said {
        std::string text;
        bool refused = false;
    };

    /// The scene of the start. \throws IoError.
    void keep_first() const;

    /// Now and then looks at the file, hands a change over to the loop and keeps it; what to say of it, if anything.
    std::optional<Said> look(LiveLoop& loop);

    /// Scenes that the loop has taken, the first included.
    const std::vector<FeltScene>& taken() const noexcept { return taken_; }

private:
    static std::optional<std::uint32_t> hand_over(LiveLoop& loop, std::unique_ptr<LiveLaw> law);
    void take(std::uint32_t path, std::string toml);
    std::string keep(const FeltScene& scene) const;
    void write(const FeltScene& scene) const;
    std::filesystem::path file_of(std::uint32_t path) const;

    SceneWatch watch_;
    const std::string name_;
    const std::filesystem::path beside_;
    const bool has_hand_;
    int looks_ = 0;
    std::vector<FeltScene> taken_;
};

} // namespace forceshade::device
