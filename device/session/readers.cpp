#include "device/session/readers.h"

#include <algorithm>
#include <arpa/inet.h>
#include <bit>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cmath>
#include <fcntl.h>
#include <iterator>
#include <netinet/in.h>
#include <poll.h>
#include <string_view>
#include <sys/file.h>
#include <sys/socket.h>
#include <system_error>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include "host/error.h"
#include "host/output/files.h"
#include "live_view_page.h"
#include "shaders/shared/law.h"

namespace forceshade::device {

namespace {

constexpr std::size_t kText = std::size_t(1) << 18;   // bytes gathered before they are written
constexpr auto kPause = std::chrono::milliseconds(5); // between checks of an empty ring
constexpr auto kPatience = std::chrono::seconds(2);   // for a pipe's reader that does not read, at the end

// Empty, and locked until it is closed. File systems without locks are not supported.
void make_ours(int descriptor, const std::filesystem::path& file) {
    if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
        ::close(descriptor);
        throw UsageError("--log {}: another run writes it now; choose another name", file.string());
    }
    if (::ftruncate(descriptor, 0) != 0 && errno != EINVAL) { // a pipe has no length
        const int error = errno;
        ::close(descriptor);
        throw file_error("write", file, error);
    }
}

// A device such as /dev/null or a pipe has no content to replace. Does not wait for a pipe's reader. A link to a file
// is replaced, not followed.
int create(const std::filesystem::path& file, bool replace) {
    std::error_code ignored;
    const std::filesystem::file_status status = std::filesystem::status(file, ignored);
    const bool special = std::filesystem::is_fifo(status) || std::filesystem::is_character_file(status);
    if (replace && !special && std::filesystem::is_symlink(file, ignored))
        std::filesystem::remove(file, ignored);
    const int flags = O_WRONLY | O_CLOEXEC | (special ? O_NONBLOCK : O_CREAT | O_NOFOLLOW | (replace ? 0 : O_EXCL));
    const int descriptor = ::open(file.c_str(), flags, 0666);
    if (descriptor >= 0 && !std::filesystem::is_character_file(status))
        make_ours(descriptor, file);
    if (descriptor >= 0)
        return descriptor;
    if (errno == EEXIST)
        throw UsageError("--log {}: is there already, and a recording is not replaced by accident; choose another "
                         "name, or use --overwrite, or --no-clobber to keep it and not run",
                         file.string());
    if (errno == ENXIO && special)
        throw IoError("cannot write {}: this pipe has no reader; start its reader first", file.string());
    throw file_error("write", file, errno);
}

constexpr double kSendBuffered = 2;                       /* s: of samples, while this machine is busy */
constexpr auto kSendPause = std::chrono::milliseconds(1); // between checks of an empty ring

static_assert(std::endian::native == std::endian::little, "doubles go out as they lie in memory");

// The address as the system expects it; no length: it is invalid.
struct SocketAddress {
    sockaddr_storage storage{};
    ::socklen_t length = 0;

    explicit SocketAddress(const UdpAddress& address) {
        auto* const four = reinterpret_cast<sockaddr_in*>(&storage);
        auto* const six = reinterpret_cast<sockaddr_in6*>(&storage);
        if (::inet_pton(AF_INET, address.host.c_str(), &four->sin_addr) == 1) {
            storage.ss_family = AF_INET;
            four->sin_port = htons(address.port);
            length = sizeof *four;
        } else if (::inet_pton(AF_INET6, address.host.c_str(), &six->sin6_addr) == 1) {
            storage.ss_family = AF_INET6;
            six->sin6_port = htons(address.port);
            length = sizeof *six;
        }
    }
    const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&storage); }
};

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

LiveLog::LiveLog(const std::filesystem::path& file, double room, Precision precision, bool replace, bool with_buttons)
    : SampleReader(room), path_(file), single_(precision == Precision::f32), with_buttons_(with_buttons),
      descriptor_(create(file, replace)), text_("path,t,x,y,z,gx,gy,gz,fx,fy,fz,depth,facet,cx,cy,cz,energy,tick,late_"
                                                "ns,read_ns,compute_ns,write_ns,happened,scene") {
    text_ += with_buttons ? ",buttons\n" : "\n";
    write_out();
    if (!failure_.empty()) {
        ::close(descriptor_);
        if (std::error_code ignored; std::filesystem::is_regular_file(file, ignored))
            std::filesystem::remove(file, ignored);
        throw IoError(failure_);
    }
    start(kPause, [this](std::span<const LiveSample> samples) {
        for (const LiveSample& sample : samples)
            add(sample);
        pending_ += samples.size();
        if (samples.empty() || text_.size() >= kText)
            write_out();
    });
}

void LiveLog::close() {
    if (!stop())
        return;
    if (failure_.empty() && ::fsync(descriptor_) != 0 && errno != EINVAL) // a pipe has no disk
        fail(errno);
    if (::close(descriptor_) != 0 && failure_.empty())
        fail(errno);
}

template <typename... Numbers> void LiveLog::add_numbers(Numbers... values) {
    const auto add_one = [this](auto value) {
        char digits[40]; // the shortest form of a double has 24 at most
        const char* const end = std::to_chars(digits, digits + sizeof digits, value).ptr;
        text_.append(digits, static_cast<std::size_t>(end - digits));
        text_ += ',';
    };
    (add_one(values), ...);
}

void LiveLog::add(const LiveSample& sample) {
    const auto add_real = [this](double value) { // in the law's precision
        single_ ? add_numbers(static_cast<float>(value)) : add_numbers(value);
    };
    add_numbers(sample.path, sample.time);
    for (const glm::dvec3& vector : {sample.probe, sample.proxy, sample.force})
        for (int i = 0; i < 3; ++i)
            add_real(vector[i]);
    add_real(sample.depth);
    if (sample.facet == layout::kNoFacet)
        text_ += "-1,";
    else
        add_numbers(sample.facet);
    add_numbers(sample.commanded.x, sample.commanded.y, sample.commanded.z, sample.energy, sample.tick, sample.late,
                sample.reading, sample.computing, sample.writing);
    fmt::format_to(std::back_inserter(text_), "{},{:016x}", flag_names(sample.flags, "+"), sample.scene);
    if (with_buttons_)
        fmt::format_to(std::back_inserter(text_), ",{}", sample.buttons);
    text_ += '\n';
}

void LiveLog::write_out() {
    std::size_t done = 0;
    while (failure_.empty() && done < text_.size()) {
        const ::ssize_t count = ::write(descriptor_, text_.data() + done, text_.size() - done);
        if (count >= 0)
            done += static_cast<std::size_t>(count);
        else if (errno == EAGAIN)
            await_reader();
        else if (errno != EINTR)
            fail(errno);
    }
    if (failure_.empty()) {
        bytes_ += text_.size();
        written_.fetch_add(pending_, std::memory_order_relaxed);
    } else
        lost_.fetch_add(pending_, std::memory_order_relaxed);
    pending_ = 0;
    text_.clear();
}

// Of a pipe. While the loop runs it may be slow: the ring keeps the samples as long as it has room.
void LiveLog::await_reader() {
    pollfd pipe{descriptor_, POLLOUT, 0};
    constexpr int kLook = 20; /* ms */
    if (::poll(&pipe, 1, kLook) > 0 || !is_stopping()) {
        patient_until_ = Clock::now() + kPatience;
        return;
    }
    if (Clock::now() > patient_until_)
        fail(ETIMEDOUT);
}

// Removes a line that was cut off, so that only whole lines stay.
void LiveLog::fail(int number) {
    failure_ = file_error("write", path_, number).what();
    if (::lseek(descriptor_, 0, SEEK_CUR) <= 0) // a pipe or device has no end to cut off
        return;
    if (::ftruncate(descriptor_, static_cast<::off_t>(bytes_)) != 0)
        failure_ += "; its last line is not whole";
}

UdpAddress parse_udp_address(const std::string& text) {
    constexpr std::string_view kBegin = "udp:";
    UdpAddress address;
    const std::size_t colon = text.rfind(':');
    bool is_right = text.starts_with(kBegin);
    if (is_right && colon >= kBegin.size()) {
        address.host = text.substr(kBegin.size(), colon - kBegin.size());
        const bool has_brackets = address.host.starts_with('[') && address.host.ends_with(']');
        if (has_brackets)
            address.host = address.host.substr(1, address.host.size() - 2);
        is_right = has_brackets == (address.host.find(':') != std::string::npos);
    }
    const char* const end = text.data() + text.size();
    const auto [read, error] =
        std::from_chars(text.data() + (colon == std::string::npos ? 0 : colon + 1), end, address.port);
    if (!is_right || error != std::errc() || read != end || address.port == 0 || SocketAddress(address).length == 0)
        throw UsageError("--send {}: must be a port from 1 to 65535 of this machine, as in udp:5005, or an address "
                         "with a port, as in udp:192.168.1.20:5005 or udp:[::1]:5005",
                         text);
    return address;
}

std::string udp_text(const UdpAddress& address) {
    const bool is_six = address.host.find(':') != std::string::npos;
    return fmt::format("udp:{}:{}", is_six ? "[" + address.host + "]" : address.host, address.port);
}

UdpSender::UdpSender(const UdpAddress& address, double rate) : SampleReader(kSendBuffered * rate) {
    const SocketAddress there(address);
    socket_ = ::socket(there.storage.ss_family, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    // Connected, so that the system reports a missing receiver.
    if (socket_ < 0 || ::connect(socket_, there.get(), there.length) != 0) {
        const std::string why = std::generic_category().message(errno);
        if (socket_ >= 0)
            ::close(socket_);
        throw IoError("--send {}: cannot send there: {}", udp_text(address), why);
    }
    start(kSendPause, [this](std::span<const LiveSample> samples) { send(samples); });
}

void UdpSender::close() {
    if (!stop())
        return;
    int error = 0;
    ::socklen_t size = sizeof error;
    if (::getsockopt(socket_, SOL_SOCKET, SO_ERROR, &error, &size) == 0 && error != 0)
        is_refused(error);
    ::close(socket_);
}

std::string UdpSender::failure() const {
    if (error_ == 0)
        return {};
    return std::generic_category().message(error_) + (error_ == ECONNREFUSED ? ": no receiver listens there" : "");
}

void UdpSender::send(std::span<const LiveSample> samples) {
    while (!samples.empty()) {
        const std::span<const LiveSample> some = samples.first(std::min(samples.size(), kTogether));
        double* to = records_.data();
        for (const LiveSample& sample : some) {
            *to++ = sample.time;
            for (const glm::dvec3& vector : {sample.probe, sample.proxy, sample.force, sample.commanded})
                for (int i = 0; i < 3; ++i)
                    *to++ = vector[i];
            *to++ = sample.depth;
            *to++ = sample.facet == layout::kNoFacet ? -1.0 : static_cast<double>(sample.facet);
            *to++ = static_cast<double>(sample.tick);
        }
        send_records(some.size());
        samples = samples.subspan(some.size());
    }
}

void UdpSender::send_records(std::size_t count) {
    const std::size_t bytes = count * kColumns * sizeof(double);
    const auto try_to = [&] { return ::send(socket_, records_.data(), bytes, MSG_NOSIGNAL) >= 0; };
    if (try_to() || (is_refused(errno) && try_to())) {
        sent_ += count;
        last_ = count;
    }
}

// The next call reports a missing receiver of the previous datagram, and then has no other effect.
bool UdpSender::is_refused(int error) {
    error_ = error;
    if (error != ECONNREFUSED)
        return false;
    sent_ -= std::exchange(last_, 0);
    return true;
}

LiveView::LiveView(std::uint16_t port, ViewedRun run)
    : SampleReader(kViewBuffered * run.rate), run_(std::move(run)),
      together_(static_cast<std::uint64_t>(std::max(1.0, std::ceil(run_.rate / kShownRate)))),
      server_({{kView, std::string(pages::view_html)}}, port) {
    start(kViewPause, [this](std::span<const LiveSample> samples) {
        for (const LiveSample& sample : samples)
            add(sample);
        if (std::chrono::steady_clock::now() - shown_ >= kFrameEach)
            show();
    });
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
