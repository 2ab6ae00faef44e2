// Queries an address, holds a connection, and runs the thread that keeps commands and answers in lock-step. Only this
// source sees Boost.Beast, which takes 25 s to compile.
#include "device/backends/haply.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <functional>
#include <optional>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <type_traits>
#include <unistd.h>

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <fmt/format.h>

#include "host/error.h"

namespace forceshade::device {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using Tcp = asio::ip::tcp;
using ErrorCode = boost::system::error_code;
using WebSocket = websocket::stream<beast::tcp_stream, false>; // the service does not compress
// Completion handlers. Erased types: each operation of Beast compiles once, not once a lambda.
using Ended = std::function<void(const ErrorCode&)>;
using Moved = std::function<void(const ErrorCode&, std::size_t)>;
using Connected = std::function<void(const ErrorCode&, const Tcp::endpoint&)>;
using Resolved = std::function<void(const ErrorCode&, const Tcp::resolver::results_type&)>;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr std::size_t kLongestMessage = std::size_t(1) << 20; // bytes; an inventory has some thousand
constexpr milliseconds kSilence{50};                          // after which a silent live loop counts as dead
constexpr milliseconds kGiveUp{1000};                         // for a late answer, before the connection counts as dead
constexpr milliseconds kFarewell{200};                        // from `stopping` to the end of the thread
constexpr milliseconds kFirstPause{20}, kLongestPause{1000};  // before reconnecting

constexpr const char* kClosed = "the connection to the Inverse Service broke; reconnecting";

milliseconds milliseconds_of(double seconds) {
    return milliseconds(static_cast<std::int64_t>(seconds * 1e3));
}

/// Why an operation failed that had `wait` s to end.
std::string trouble(const ErrorCode& error, double wait) {
    if (error == beast::error::timeout)
        return fmt::format("no answer within {} s", wait);
    if (error == asio::error::connection_refused)
        return "connection refused: no service listens there";
    if (error == websocket::error::message_too_big || error == websocket::error::buffer_overflow)
        return fmt::format("it sent a message of more than {} bytes", kLongestMessage);
    if (error == websocket::error::closed || error == asio::error::eof || error == asio::error::connection_reset ||
        error == beast::http::error::end_of_stream)
        return "it closed the connection";
    if (error.category() == beast::http::make_error_code(beast::http::error::end_of_stream).category())
        return fmt::format("the answer is not from a WebSocket ({})", error.message());
    return error.message();
}

/// One connection to the service. Handlers that are under way hold it, so that it outlives being replaced.
struct Line : std::enable_shared_from_this<Line> {
    using Done = std::function<void(const ErrorCode&, const std::string& inventory)>;

    explicit Line(asio::io_context& io) : socket(io), resolver(io) {}

    /// Connects and waits for the service's inventory; after the look-up of the name for at most `limit` a step, if
    /// that is not 0.
    void dial(const Address& address, milliseconds limit, Done done) {
        const auto self = shared_from_this();
        const auto begin_step = [self, limit] {
            if (limit != milliseconds(0))
                self->socket.next_layer().expires_after(limit);
        };
        const Moved read = [self, done](const ErrorCode& error, std::size_t) {
            done(error, error ? "" : self->take_text());
        };
        const Ended greeted = [self, begin_step, done, read](const ErrorCode& error) {
            if (error)
                return done(error, {});
            begin_step();
            self->socket.async_read(self->received, read);
        };
        const Connected connected = [self, begin_step, done, greeted, address](const ErrorCode& error,
                                                                               const Tcp::endpoint&) {
            if (error)
                return done(error, {});
            ErrorCode ignored;
            self->socket.next_layer().socket().set_option(Tcp::no_delay(true), ignored);
            begin_step();
            self->socket.async_handshake(self->response, address.host_field(), address.path, greeted);
        };
        socket.read_message_max(kLongestMessage);
        const Resolved resolved = [self, begin_step, done, connected](const ErrorCode& error,
                                                                      const Tcp::resolver::results_type& places) {
            if (error)
                return done(error, {});
            begin_step();
            self->socket.next_layer().async_connect(places, connected);
        };
        resolver.async_resolve(address.host, address.port, resolved);
    }

    /// The text received.
    std::string take_text() {
        std::string text(static_cast<const char*>(received.data().data()), received.size());
        received.consume(received.size());
        return text;
    }

    /// At once; operations that are under way end with an error.
    void close() {
        ErrorCode ignored;
        resolver.cancel();
        Tcp::socket& tcp = socket.next_layer().socket();
        tcp.shutdown(Tcp::socket::shutdown_both, ignored);
        tcp.close(ignored);
    }

    WebSocket socket;
    Tcp::resolver resolver;
    websocket::response_type response; // to the handshake
    beast::flat_buffer received;
    std::string command;  // that is being written
    bool writing = false; // one at a time
};

/// Queries an address step by step, each with its own time limit, sending no command.
class Look {
public:
    Look(const Address& address, double wait) : address_(address), wait_(milliseconds_of(wait)), wait_s_(wait) {}

    HaplyFinding find(std::string url) {
        HaplyFinding finding;
        finding.url = std::move(url);
        if (const ErrorCode error = ask_version(finding.version))
            finding.problem = trouble(error, wait_s_);
        else
            ask_inventory(finding);
        return finding;
    }

private:
    /// Runs one operation to its end. `start` gets the handler to call.
    template <typename Start> ErrorCode step(const Start& start) {
        ErrorCode outcome = asio::error::would_block;
        start([&outcome](const ErrorCode& error, auto&&...) { outcome = error; });
        io_.restart();
        io_.run();
        return outcome;
    }

    /// Only a missing service is an error: a service need not report its version.
    ErrorCode ask_version(std::string& version) {
        Tcp::resolver resolver(io_);
        Tcp::resolver::results_type places;
        beast::tcp_stream stream(io_);
        ErrorCode error = step([&](Ended done) {
            resolver.async_resolve(address_.host, address_.port,
                                   Resolved([&places, done](const ErrorCode& failure, const auto& found) {
                                       places = found;
                                       done(failure);
                                   }));
        });
        stream.expires_after(wait_);
        if (!error)
            error = step([&](Connected done) { stream.async_connect(places, done); });
        if (error)
            return error;
        http::request<http::empty_body> request{http::verb::get, "/version", 11};
        request.set(http::field::host, address_.host_field());
        request.set(http::field::connection, "close");
        beast::flat_buffer buffer(kLongestMessage);
        http::response<http::string_body> response;
        stream.expires_after(wait_);
        error = step([&](Moved done) { http::async_write(stream, request, done); });
        if (!error)
            error = step([&](Moved done) { http::async_read(stream, buffer, response, done); });
        if (!error && response.result() == http::status::ok)
            version = read_version(response.body());
        return {};
    }

    void ask_inventory(HaplyFinding& finding) {
        const auto line = std::make_shared<Line>(io_);
        std::string inventory;
        const ErrorCode error = step([&](Ended done) {
            line->dial(address_, wait_, [&inventory, done](const ErrorCode& failure, const std::string& text) {
                inventory = text;
                done(failure);
            });
        });
        if (error) {
            finding.problem = error != websocket::error::upgrade_declined
                                  ? trouble(error, wait_s_)
                                  : fmt::format("an HTTP server answers there, but not as a WebSocket (status {})",
                                                static_cast<unsigned>(line->response.result_int()));
            return;
        }
        if (auto devices = read_inventory(inventory))
            finding.devices = std::move(*devices);
        else
            finding.problem = "the answer has no inventory of devices: it is not the Inverse Service 3.x";
        finding.has_grip = tells_of_grip(inventory);
        line->socket.next_layer().expires_after(std::min(wait_, milliseconds(200)));
        step([&](Ended done) { line->socket.async_close(websocket::close_code::normal, done); });
    }

    const Address& address_;
    const milliseconds wait_;
    const double wait_s_;
    asio::io_context io_{1};
};

class Link {
public:
    Link(Exchange& exchange, const HaplyOptions& options)
        : exchange_(exchange), options_(options), address_(parse_address(options.url)) {
        wake_.assign(::dup(exchange.wake_descriptor()));
    }

    void run() {
        listen();
        watch();
        connect();
        io_.run();
    }

private:
    enum class Phase { connecting, running, leaving, over };
    using LinePointer = std::shared_ptr<Line>;

    template <typename Act> void arm(asio::steady_timer& timer, milliseconds time, Act act) {
        timer.expires_after(time);
        timer.async_wait([&timer, act](const ErrorCode& error) {
            if (!error && timer.expiry() <= steady_clock::now()) // neither cancelled nor set again meanwhile
                act();
        });
    }

    /// A handler that continues, with the results or without, if no error occurred and the connection is still in use.
    template <typename Next> auto on(const LinePointer& line, const char* error_text, Next next) {
        return [this, line, error_text, next](const ErrorCode& error, auto&&... results) {
            if (line != line_)
                return;
            if (error)
                return lose(error_text);
            if constexpr (std::is_invocable_v<Next, decltype(results)...>)
                next(results...);
            else if constexpr (std::is_invocable_v<Next>)
                next();
        };
    }

    void listen() {
        wake_.async_wait(asio::posix::stream_descriptor::wait_read, [this](const ErrorCode& error) {
            if (error)
                return;
            std::uint64_t count = 0;
            [[maybe_unused]] const auto size = ::read(wake_.native_handle(), &count, sizeof count);
            if (exchange_.stopping)
                return take_leave();
            if (exchange_.force.take(wish_)) {
                pending_ = true;
                watch();
            }
            if (exchange_.resting.exchange(false)) { // after the newest force was read: an older one does not win
                wish_ = glm::dvec3(0);
                pending_ = true;
            }
            pump();
            listen();
        });
    }

    /// The loop's own watchdog stops with the loop; this one does not. It also asks for positions while no force is
    /// written.
    void watch() {
        arm(silence_, kSilence, [this] {
            wish_ = glm::dvec3(0);
            pending_ = true;
            pump();
            watch();
        });
    }

    // Otherwise a short refusal could end before the loop sees it, and the full force would come back at once.
    void tell_withheld() {
        const char* why = objection(unmet_);
        if (why != nullptr)
            exchange_.lately_withheld = why;
        exchange_.withheld = why;
    }

    void connect() {
        phase_ = Phase::connecting;
        step_.reset();
        late_ = false;
        const LinePointer line = line_ = std::make_shared<Line>(io_);
        arm(limit_, milliseconds_of(options_.wait), [this] { lose("the Inverse Service accepts no connection"); });
        line->dial(address_, milliseconds(0),
                   on(line, "the Inverse Service is not there",
                      [this, line](const std::string& inventory) { begin(line, inventory); }));
    }

    void begin(const LinePointer& line, const std::string& inventory) {
        const HaplyDevice* device = nullptr;
        const auto devices = read_inventory(inventory).value_or(std::vector<HaplyDevice>());
        for (const HaplyDevice& each : devices)
            if (each.id == options_.device_id)
                device = &each;
        if (device == nullptr)
            return lose("the Inverse Service does not list the device");
        const std::optional<Axes> axes = parse_basis(device->basis);
        if (!axes)
            return lose("the Inverse Service gives the device's axes in an unknown form");
        axes_ = *axes;
        unmet_ = device->unmet; // replaces the state from before the connection broke
        tell_withheld();
        limit_.cancel();
        phase_ = Phase::running;
        exchange_.lend_line(line->socket.next_layer().socket().native_handle());
        exchange_.there = true;
        hear(line);
        send(glm::dvec3(0));
    }

    void pump() {
        if (phase_ != Phase::running || !pending_ || line_->writing || step_.owed() > 0)
            return;
        pending_ = false;
        send(wish_);
    }

    void send(glm::dvec3 force) {
        if (!is_finite(force) || exchange_.stopping || unmet_ != 0)
            force = glm::dvec3(0);
        const LinePointer line = line_;
        write_command(line->command, options_.dialect, options_.device_id, axes_.to_service(force));
        line->writing = true;
        step_.sent();
        if (phase_ == Phase::running)
            arm(answer_, late_ ? kGiveUp : milliseconds_of(options_.patience), [this] { miss(); });
        line->socket.async_write(asio::buffer(line->command), Moved(on(line, kClosed, [this, line] {
                                     line->writing = false;
                                     phase_ == Phase::leaving ? last_word() : pump();
                                 })));
    }

    /// The answer is late. The service may still apply the command under way when it wakes up: no force may follow it.
    void miss() {
        if (step_.owed() == 0)
            return;
        exchange_.measurement.put({});
        if (late_)
            return lose("the Inverse Service does not answer any more; reconnecting");
        exchange_.error_text = "the Inverse Service does not answer in time";
        late_ = true;
        if (line_->writing)
            arm(answer_, kGiveUp, [this] { miss(); });
        else
            send(glm::dvec3(0));
    }

    void hear(const LinePointer& line) {
        line->socket.async_read(line->received, Moved(on(line, kClosed, [this, line] {
                                    const std::string text = line->take_text();
                                    const LockStep::Kind kind = step_.answered();
                                    if (phase_ == Phase::leaving)
                                        return said_ && step_.owed() == 0 ? hang_up() : hear(line);
                                    if (kind == LockStep::Kind::current)
                                        take_state(text);
                                    else if (kind == LockStep::Kind::unasked)
                                        exchange_.error_text =
                                            "the Inverse Service sent a state that was not asked for; it was dropped";
                                    hear(line);
                                    pump();
                                })));
    }

    void take_state(const std::string& text) {
        answer_.cancel();
        late_ = false;
        const State state = read_state(text, options_.device_id);
        unmet_ = (unmet_ & ~state.readiness.known) | state.readiness.unmet;
        tell_withheld();
        if (state.fault == nullptr) {
            exchange_.measurement.put({true, now(), axes_.to_world(state.position), state.buttons});
            pause_ = kFirstPause;
        } else {
            exchange_.error_text = state.fault;
            exchange_.measurement.put({});
        }
    }

    void drop_line() {
        exchange_.there = false;
        exchange_.measurement.put({});
        exchange_.lend_line(-1);
        if (line_ == nullptr)
            return;
        line_->close();
        line_.reset();
    }

    void lose(const char* error_text) {
        if (phase_ == Phase::leaving || phase_ == Phase::over)
            return finish();
        exchange_.error_text = error_text;
        drop_line();
        limit_.cancel();
        answer_.cancel();
        phase_ = Phase::connecting;
        arm(retry_, pause_, [this] { connect(); });
        pause_ = std::min(2 * pause_, kLongestPause);
    }

    void take_leave() {
        if (phase_ != Phase::running)
            return finish();
        phase_ = Phase::leaving;
        silence_.cancel();
        answer_.cancel();
        arm(limit_, kFarewell, [this] { finish(); });
        if (!line_->writing)
            last_word();
    }

    /// A last command without force; the lock-step does not matter any more.
    void last_word() {
        if (!said_)
            send(glm::dvec3(0));
        said_ = true;
    }

    void hang_up() {
        const LinePointer line = line_;
        line->socket.async_close(websocket::close_code::normal, Ended([this, line](const ErrorCode&) { finish(); }));
    }

    void finish() {
        phase_ = Phase::over;
        drop_line();
        io_.stop();
    }

    Exchange& exchange_;
    const HaplyOptions& options_;
    const Address address_;
    asio::io_context io_{1};
    asio::posix::stream_descriptor wake_{io_};
    asio::steady_timer limit_{io_}, answer_{io_}, silence_{io_}, retry_{io_};
    LinePointer line_;
    LockStep step_;
    Axes axes_;
    Phase phase_ = Phase::connecting;
    glm::dvec3 wish_{0}; /* N, in the world's axes: to be sent */
    unsigned unmet_ = 0; // conditions for a force, as bits
    bool pending_ = false, late_ = false, said_ = false;
    milliseconds pause_ = kFirstPause;
};

} // namespace

Exchange::Exchange(std::string zero_frame) : zero_frame_(std::move(zero_frame)) {
    wake_ = ::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
    null_device_ = ::open("/dev/null", O_WRONLY | O_CLOEXEC); // not a socket, so that sending to it fails
    line_ = null_device_ < 0 ? -1 : ::fcntl(null_device_, F_DUPFD_CLOEXEC, 0);
    if (wake_ < 0 || line_ < 0) {
        const int error = errno;
        for (const int descriptor : {wake_, null_device_, line_})
            if (descriptor >= 0)
                ::close(descriptor);
        throw Error(ExitCode::io, fmt::format("haply: cannot open a file descriptor: {}", std::strerror(error)));
    }
}

Exchange::~Exchange() {
    for (const int descriptor : {wake_, null_device_, line_})
        ::close(descriptor);
}

void Exchange::wake() const noexcept {
    const int error = errno;
    const std::uint64_t one = 1;
    [[maybe_unused]] const auto written = ::write(wake_, &one, sizeof one); // full: it is awake
    errno = error;
}

void Exchange::stop() noexcept {
    const int error = errno;
    if (!stopping.exchange(true)) {
        [[maybe_unused]] const auto sent =
            ::send(line_, zero_frame_.data(), zero_frame_.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    }
    wake();
    errno = error;
}

void Exchange::lend_line(int socket) noexcept {
    ::dup3(socket < 0 ? null_device_ : socket, line_, O_CLOEXEC);
}

HaplyFinding look_for_haply(const std::string& url, double wait) {
    return Look(parse_address(url), wait).find(url);
}

void run_link(Exchange& exchange, const HaplyOptions& options) noexcept {
    try {
        Link(exchange, options).run();
    } catch (...) { // no memory; the connection is gone too, and the service applies no force to a silent client
        exchange.error_text = "the thread that talks to the Inverse Service failed";
    }
    exchange.lend_line(-1);
    exchange.there = false;
    exchange.measurement.put({});
}

} // namespace forceshade::device
