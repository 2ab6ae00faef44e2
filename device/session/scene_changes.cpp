#include "device/session/scene_changes.h"

#include <chrono>
#include <exception>
#include <system_error>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "host/error.h"
#include "host/output/files.h"

namespace forceshade::device {

SceneWatch::SceneWatch(std::filesystem::path file, std::function<PreparedCase()> read, const Scene& first)
    : file_(std::move(file)), read_(std::move(read)), first_(first), last_(stamp()), asked_(last_) {}

SceneWatch::Stamp SceneWatch::stamp() const {
    std::error_code ignored; // a file that is being replaced may be gone for a moment
    return {std::filesystem::last_write_time(file_, ignored), std::filesystem::file_size(file_, ignored)};
}

bool SceneWatch::has_changed() {
    const Stamp now = stamp();
    if (std::exchange(asked_, now) != now || now == last_)
        return false;
    last_ = now;
    return true;
}

SceneWatch::Change SceneWatch::look() {
    Change change;
    try {
        if (last_.size == 0)
            throw UsageError("its file is empty");
        PreparedCase prepared = read_();
        const Scene& scene = prepared.one.scene;
        if (scene.precision != first_.precision)
            throw UsageError("run.precision cannot change while the loop runs: its log has one precision");
        change.moves_otherwise = scene.paths != first_.paths || scene.hand != first_.hand;
        change.scene = prepared.scene;
        change.law = make_live_law(std::move(prepared));
    } catch (const std::exception& error) {
        change.refusal = error.what();
    }
    return change;
}

std::optional<SceneChanges::Said> SceneChanges::look(LiveLoop& loop) {
    constexpr int kLooks = 10; // between looks at the file
    if (looks_++ % kLooks != 0 || !watch_.has_changed())
        return std::nullopt;
    SceneWatch::Change change = watch_.look();
    if (!change.law)
        return Said{fmt::format("the scene stays as it was: {}", change.refusal), true};
    const std::optional<std::uint32_t> path = hand_over(loop, std::move(change.law));
    if (!path) // the loop has ended, or does not come round
        return std::nullopt;
    take(*path, std::move(change.scene));
    std::string said =
        fmt::format("{} was read again, path {} from {:.3f} s on", name_, *path, loop.status().seconds.load());
    if (change.moves_otherwise && has_hand_)
        said += "; [paths] and [hand] stay as they were at the start";
    said += keep(taken_.back());
    return Said{said, false};
}

// The path that the law begins; none if the loop does not take it within a second.
std::optional<std::uint32_t> SceneChanges::hand_over(LiveLoop& loop, std::unique_ptr<LiveLaw> law) {
    const LoopStatus& status = loop.status();
    const std::uint32_t before = status.laws.load(std::memory_order_acquire);
    loop.offer(std::move(law));
    for (int i = 0; i < 1000 && loop.end() == LoopEnd::running; ++i) {
        if (status.laws.load(std::memory_order_acquire) != before)
            return status.law_path.load();
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    if (loop.end() == LoopEnd::running && !loop.withdraw()) // at the last moment
        return status.law_path.load();
    return std::nullopt;
}

void SceneChanges::take(std::uint32_t path, std::string toml) {
    std::string sha256 = sha256_of(toml);
    taken_.push_back({path, std::move(toml), std::move(sha256)});
}

std::filesystem::path SceneChanges::file_of(std::uint32_t path) const {
    return fmt::format("{}.scene-{}.toml", beside_.string(), path);
}

void SceneChanges::write(const FeltScene& scene) const {
    if (!beside_.empty())
        write_file_atomically(file_of(scene.path), scene.toml);
}

void SceneChanges::keep_first() const {
    write(taken_.front());
}

std::string SceneChanges::keep(const FeltScene& scene) const {
    try {
        write(scene);
        return beside_.empty() ? "" : fmt::format("; kept as {}", file_of(scene.path).filename().string());
    } catch (const IoError& error) { // no reason to stop a loop
        return fmt::format("; {}", error.what());
    }
}

} // namespace forceshade::device
