#include "device/session/scene_watch.h"

#include <exception>
#include <system_error>
#include <utility>

#include "host/error.h"

namespace forceshade::device {

SceneWatch::SceneWatch(std::filesystem::path file, std::function<PreparedCase()> read, Precision precision)
    : file_(std::move(file)), read_(std::move(read)), precision_(precision), last_(stamp()) {}

SceneWatch::Stamp SceneWatch::stamp() const {
    std::error_code ignored; // a file that is being replaced may be gone for a moment
    return {std::filesystem::last_write_time(file_, ignored), std::filesystem::file_size(file_, ignored)};
}

bool SceneWatch::has_changed() {
    const Stamp now = stamp();
    return std::exchange(last_, now) != now;
}

SceneWatch::Change SceneWatch::look() {
    Change change;
    try {
        PreparedCase prepared = read_();
        if (prepared.one.scene.precision != precision_)
            throw UsageError("run.precision cannot change while the loop runs: its log has one precision");
        change.scene = prepared.scene;
        change.law = make_live_law(std::move(prepared));
    } catch (const std::exception& error) {
        change.refusal = error.what();
    }
    return change;
}

} // namespace forceshade::device
