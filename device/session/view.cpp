#include "device/session/view.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include "live_view_page.h"

namespace forceshade::device {

namespace {

using ViewJson = nlohmann::ordered_json;

constexpr const char* kView = "view";
constexpr double kViewBuffered = 2;                        /* s: of samples, while a browser is slow */
constexpr double kShownRate = 1000;                        /* Hz: of pairs of samples */
constexpr auto kViewPause = std::chrono::milliseconds(5);  // between checks of an empty ring
constexpr auto kFrameEach = std::chrono::milliseconds(33); // between frames

// Texts of devices need not be UTF-8; NaN and infinity become null.
std::string text_of(const ViewJson& json) {
    return json.dump(-1, ' ', false, ViewJson::error_handler_t::replace);
}

} // namespace

LiveView::LiveView(std::uint16_t port, ViewedRun run)
    : run_(std::move(run)), together_(static_cast<std::uint64_t>(std::max(1.0, std::ceil(run_.rate / kShownRate)))),
      ring_(static_cast<std::size_t>(kViewBuffered * run_.rate)),
      server_({{kView, std::string(pages::view_html)}}, port),
      thread_([this](const std::stop_token& stop) { this->run(stop); }) {}

LiveView::~LiveView() {
    stop();
}

std::string LiveView::address() const {
    return server_.address(kView);
}

void LiveView::update(const LiveStatus& status) {
    const std::lock_guard lock(mutex_);
    status_ = status;
}

void LiveView::close(const std::string& ended) {
    stop();
    show();
    server_.send(kView, text_of({{"type", "end"}, {"ended", ended}}));
}

void LiveView::stop() {
    if (!thread_.joinable())
        return;
    thread_.request_stop();
    thread_.join();
}

void LiveView::run(const std::stop_token& stop) {
    drain(ring_, stop, kViewPause, [this](std::span<const LiveSample> samples) {
        for (const LiveSample& sample : samples)
            add(sample);
        if (std::chrono::steady_clock::now() - shown_ >= kFrameEach)
            show();
    });
}

// By the sum of both forces: keeps a peak of the law's force, and a gap in the force sent to the device.
void LiveView::add(const LiveSample& sample) {
    const double sum = glm::length(sample.force) + glm::length(sample.commanded);
    const double force = std::isfinite(sum) ? sum : HUGE_VAL;
    if (gathered_ == 0 || force < least_force_) {
        least_ = sample;
        least_force_ = force;
    }
    if (gathered_ == 0 || force > largest_force_) {
        largest_ = sample;
        largest_force_ = force;
    }
    if (++gathered_ < together_)
        return;
    gathered_ = 0;
    points_.push_back(least_.tick < largest_.tick ? least_ : largest_);
    if (least_.tick != largest_.tick)
        points_.push_back(least_.tick < largest_.tick ? largest_ : least_);
}

void LiveView::show() {
    shown_ = std::chrono::steady_clock::now();
    const std::vector<LiveSample> points = std::exchange(points_, {});
    while (server_.next_event()) { // browsers' events have no effect
    }
    if (!server_.is_open(kView))
        return;
    const LiveStatus status = [this] {
        const std::lock_guard lock(mutex_);
        return status_;
    }();
    ViewJson json{{"type", "frame"},         {"scene", run_.scene},         {"device", run_.device},
                  {"asked_rate", run_.rate}, {"max_force", run_.max_force}, {"rate", status.rate},
                  {"late", status.late},     {"clamped", status.clamped},   {"lost", status.lost},
                  {"state", status.state},   {"points", ViewJson::array()}};
    for (const LiveSample& point : points) { // s, m, N, as the page reads them
        const glm::dvec3 &p = point.probe, &f = point.force, &c = point.commanded;
        json["points"].push_back({point.time, p.x, p.y, p.z, f.x, f.y, f.z, c.x, c.y, c.z, point.depth, point.path});
    }
    server_.send(kView, text_of(json));
}

} // namespace forceshade::device
