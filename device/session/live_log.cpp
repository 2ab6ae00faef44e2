#include "device/session/live_log.h"

#include <cerrno>
#include <charconv>
#include <chrono>
#include <fcntl.h>
#include <iterator>
#include <poll.h>
#include <sys/file.h>
#include <unistd.h>

#include <fmt/format.h>

#include "host/error.h"
#include "host/output/files.h"
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
        throw UsageError(fmt::format("--log {}: another run writes it now; choose another name", file.string()));
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
        throw UsageError(fmt::format("--log {}: is there already, and a recording is not replaced by accident; choose "
                                     "another name, or use --overwrite, or --no-clobber to keep it and not run",
                                     file.string()));
    if (errno == ENXIO && special)
        throw IoError(fmt::format("cannot write {}: this pipe has no reader; start its reader first", file.string()));
    throw file_error("write", file, errno);
}

} // namespace

LiveLog::LiveLog(const std::filesystem::path& file, SampleRing& ring, Precision precision, bool replace,
                 bool with_buttons)
    : path_(file), ring_(ring), single_(precision == Precision::f32), with_buttons_(with_buttons),
      descriptor_(create(file, replace)),
      text_("path,t,x,y,z,gx,gy,gz,fx,fy,fz,depth,facet,cx,cy,cz,energy,tick,late_ns,read_ns,compute_ns,write_ns,"
            "happened,scene") {
    text_ += with_buttons ? ",buttons\n" : "\n";
    write_out();
    if (!failure_.empty()) {
        ::close(descriptor_);
        if (std::error_code ignored; std::filesystem::is_regular_file(file, ignored))
            std::filesystem::remove(file, ignored);
        throw IoError(failure_);
    }
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

LiveLog::~LiveLog() {
    close();
}

void LiveLog::close() {
    if (!thread_.joinable())
        return;
    thread_.request_stop();
    thread_.join();
    if (failure_.empty() && ::fsync(descriptor_) != 0 && errno != EINVAL) // a pipe has no disk
        fail(errno);
    if (::close(descriptor_) != 0 && failure_.empty())
        fail(errno);
}

void LiveLog::run(const std::stop_token& stop) {
    stop_ = stop;
    drain(ring_, stop, kPause, [this](std::span<const LiveSample> samples) {
        for (const LiveSample& sample : samples)
            add(sample);
        pending_ += samples.size();
        if (samples.empty() || text_.size() >= kText)
            write_out();
    });
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
    bool first = true;
    for (std::size_t bit = 0; bit < kSampleFlagNames.size(); ++bit)
        if (sample.flags >> bit & 1u) {
            if (!first)
                text_ += '+';
            text_ += kSampleFlagNames[bit];
            first = false;
        }
    fmt::format_to(std::back_inserter(text_), ",{:016x}", sample.scene);
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
    if (::poll(&pipe, 1, kLook) > 0 || !stop_.stop_requested()) {
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

} // namespace forceshade::device
