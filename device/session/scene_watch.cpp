#include "device/session/scene_watch.h"

#include <exception>
#include <system_error>
#include <utility>

#include "host/error.h"

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

} // namespace forceshade::device
