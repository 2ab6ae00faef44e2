// The readers of the live loop's samples, each with a thread: a CSV file, UDP datagrams, a page.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "device/loop/sample.h"
#include "device/run_report/text.h"
#include "host/scene/scene.h"
#include "host/server/page_server.h"

namespace forceshade::device {

/// What takes samples off a ring in a thread of its own, so that none holds up another, nor the loop.
class SampleReader {
public:
    SampleReader(const SampleReader&) = delete;
    SampleReader& operator=(const SampleReader&) = delete;

    /// For the loop. A sample that finds no room there is not read.
    SampleRing& ring() noexcept { return ring_; }

protected:
    /// `room`: samples that the ring holds.
    explicit SampleReader(double room) : ring_(static_cast<std::size_t>(room)) {}
    ~SampleReader() = default;

    /// Starts the thread, which calls `take` as drain() does.
    template <typename Take> void start(std::chrono::milliseconds pause, Take take) {
        thread_ = std::thread([this, pause, take] { drain(ring_, stop_.get_token(), pause, take); });
    }
    /// When no more is put on the ring: what is left is taken, and the thread ends. False: there is none.
    bool stop() {
        if (!thread_.joinable())
            return false;
        stop_.request_stop();
        thread_.join();
        return true;
    }
    bool is_stopping() const noexcept { return stop_.stop_requested(); }

private:
    SampleRing ring_;
    std::stop_source stop_;
    std::thread thread_;
};

/// Columns path,t,x,y,z,gx,gy,gz,fx,fy,fz,depth,facet as PathWriter (host/paths/path_files.h) has them, so that
/// `explore` gives the same numbers for the same positions; then cx,cy,cz (N: what was sent to the device), energy (J:
/// given to the hand so far), tick, late_ns, read_ns, compute_ns, write_ns, happened: kSampleFlagNames joined by '+',
/// and scene: the first 16 digits of the SHA-256 of the scene; last, of a device that has some, buttons: the pressed
/// ones, button N as 2^(N - 1), added up.
///
/// The file has its own name from the start, in whole lines, so that a process that dies leaves what it wrote. When the
/// disk is full, further samples are dropped from the ring and counted as lost. A pipe with a slow reader is waited
/// for until the end and 2 s more.
class LiveLog : public SampleReader {
public:
    /// Creates the file and starts a thread that writes until close(). `room`: samples that wait for the disk. \throws
    /// IoError; UsageError if it exists and must not be replaced, or another run writes it.
    LiveLog(const std::filesystem::path& file, double room, Precision precision, bool replace,
            bool with_buttons = false);
    ~LiveLog() { close(); }

    /// When no more is put on the ring: writes the rest to the disk.
    void close();

    std::uint64_t written() const noexcept { return written_.load(std::memory_order_relaxed); } // samples
    std::uint64_t lost() const noexcept { return lost_.load(std::memory_order_relaxed); }       // samples
    /// Why the disk took no more; empty: it took all. After close().
    const std::string& failure() const noexcept { return failure_; }

private:
    void add(const LiveSample& sample);
    template <typename... Numbers> void add_numbers(Numbers... values);
    void write_out();
    void await_reader();
    void fail(int number);

    using Clock = std::chrono::steady_clock;

    std::filesystem::path path_;
    const bool single_, with_buttons_;
    int descriptor_ = -1;
    std::uint64_t bytes_ = 0;   // whole lines on the disk
    std::uint64_t pending_ = 0; // samples in text_
    std::string text_;
    std::string failure_;
    Clock::time_point patient_until_{};
    std::atomic<std::uint64_t> written_ = 0, lost_ = 0;
};

struct UdpAddress {
    std::string host = "127.0.0.1"; /* IPv4 or IPv6, in digits */
    std::uint16_t port = 0;
};

/// "udp:5005", "udp:192.168.1.20:5005" or "udp:[::1]:5005". \throws UsageError for anything else.
UdpAddress parse_udp_address(const std::string& text);
/// "udp:127.0.0.1:5005"
std::string udp_text(const UdpAddress& address);

/// Each datagram holds one to nine samples, oldest first, without a header. A sample is 16 doubles, little-endian: t
/// (s), x y z (m: probe), gx gy gz (m: proxy), fx fy fz (N: the law's force), cx cy cz (N: sent to the device), depth
/// (m), facet (-1 out of contact), tick: the numbers of the columns of LiveLog of that name.
///
/// No sample is sent twice or waited for: datagrams that the network does not take, or that a missing receiver refuses,
/// are lost.
class UdpSender : public SampleReader {
public:
    /// Starts a thread that sends until close(). `rate`: Hz. \throws IoError if it cannot send there.
    UdpSender(const UdpAddress& address, double rate);
    ~UdpSender() { close(); }

    /// When no more is put on the ring: sends the rest.
    void close();

    /// After close(): samples that left this machine, unless their receiver is known to have been absent.
    std::uint64_t sent() const noexcept { return sent_; }
    /// After close(): why others did not; empty: the network refused none.
    std::string failure() const;

private:
    static constexpr std::size_t kColumns = 16, kTogether = 9; // 1152 bytes: every network takes them whole

    void send(std::span<const LiveSample> samples);
    void send_records(std::size_t count);
    bool is_refused(int error);

    int socket_ = -1;
    std::array<double, kColumns * kTogether> records_{};
    std::uint64_t sent_ = 0, last_ = 0; // samples: all, in the last datagram
    int error_ = 0;                     // the last one
};

/// Constant facts of a run on the page.
struct ViewedRun {
    std::string scene, device; // its file's name; the device's own
    double rate = 0;           /* Hz: as asked for */
    double max_force = 0;      /* N: safety's limit; may be infinite */
};

/// Shows some 2000 samples a second, the largest and the least forces among them.
class LiveView : public SampleReader {
public:
    /// Serves the page at `port`, 0 for any that is free, and starts a thread that shows samples until close(). \throws
    /// UsageError if the port cannot be had.
    LiveView(std::uint16_t port, ViewedRun run);
    ~LiveView() { stop(); }

    std::string address() const;

    /// The status of the run; may be called at any rate.
    void update(const LiveStatus& status);

    /// When no more is put on the ring: shows the rest, and why the run ended.
    void close(const std::string& ended);

private:
    void add(const LiveSample& sample);
    void show();

    const ViewedRun run_;
    const std::uint64_t together_; // samples of which two are shown
    PageServer server_;
    std::mutex mutex_;
    LiveStatus status_; // by the mutex
    // Of the thread alone.
    LiveSample least_, largest_;
    double least_force_ = 0, largest_force_ = 0; /* N */
    std::uint64_t gathered_ = 0;                 // of those together
    std::vector<LiveSample> points_;
    std::chrono::steady_clock::time_point shown_{};
};

} // namespace forceshade::device
