#include "device/session/session.h"

#include <chrono>
#include <exception>
#include <system_error>
#include <thread>

#include <fmt/format.h>

#include "host/error.h"
#include "host/limits/linear_loop.h"
#include "host/output/files.h"

namespace forceshade::device {

namespace {

// The path that the law begins; none if the loop does not use it within a second.
std::optional<std::uint32_t> hand_over(LiveLoop& loop, std::unique_ptr<ProbeLaw> law) {
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

} // namespace

SceneChanges::SceneChanges(const std::filesystem::path& file, const std::function<PreparedCase()>& read,
                           const PreparedCase& first, std::filesystem::path stem, bool has_hand)
    : file_(file), stem_(std::move(stem)), read_(read), first_(first.one.scene), has_hand_(has_hand), last_(stamp()),
      asked_(last_), used_{{0, first.scene, sha256_of(first.scene)}} {}

SceneChanges::Stamp SceneChanges::stamp() const {
    std::error_code ignored; // a file that is being replaced may be gone for a moment
    return {std::filesystem::last_write_time(file_, ignored), std::filesystem::file_size(file_, ignored)};
}

PreparedCase SceneChanges::read_again() const {
    if (last_.second == 0)
        throw UsageError("its file is empty");
    PreparedCase prepared = read_();
    if (prepared.one.scene.precision != first_.precision)
        throw UsageError("run.precision cannot change while the loop runs: its log has one precision");
    return prepared;
}

std::optional<SceneChanges::Message> SceneChanges::look(LiveLoop& loop) {
    constexpr int kLooks = 10; // between checks of the file
    if (looks_++ % kLooks != 0)
        return std::nullopt;
    // Changed since the last read, and stable since the last check: an editor may empty it before it writes.
    const Stamp present = stamp();
    if (std::exchange(asked_, present) != present || present == last_)
        return std::nullopt;
    last_ = present;
    std::unique_ptr<ProbeLaw> law;
    PreparedCase prepared;
    try {
        prepared = read_again();
        law = make_probe_law(prepared, loop.period());
    } catch (const std::exception& error) {
        return Message{fmt::format("the scene stays as it was: {}", error.what()), true, {}};
    }
    const Scene& scene = prepared.one.scene;
    const std::optional<std::uint32_t> path = hand_over(loop, std::move(law));
    if (!path) // the loop has ended, or is stuck
        return std::nullopt;
    used_.push_back({*path, prepared.scene, sha256_of(prepared.scene)});
    std::string text = fmt::format("{} was read again, path {} from {:.3f} s on", file_.filename().string(), *path,
                                   loop.status().seconds.load());
    HandSpec with_first_coupling = scene.hand;
    with_first_coupling.coupling_stiffness = first_.hand.coupling_stiffness;
    with_first_coupling.coupling_damping = first_.hand.coupling_damping;
    with_first_coupling.coupling_filter = first_.hand.coupling_filter;
    if (has_hand_ && (scene.paths != first_.paths || with_first_coupling != first_.hand))
        text += "; [paths] and [hand] stay as they were at the start, but for its coupling";
    try {
        text += keep(used_.back());
    } catch (const IoError& error) { // not a reason to stop a loop
        text += fmt::format("; {}", error.what());
    }
    return Message{text, false, std::move(prepared)};
}

std::string SceneChanges::keep(const UsedScene& scene) const {
    if (stem_.empty())
        return "";
    const std::filesystem::path file = fmt::format("{}.scene-{}.toml", stem_.string(), scene.path);
    write_file_atomically(file, scene.toml);
    return fmt::format("; kept as {}", file.filename().string());
}

} // namespace forceshade::device
