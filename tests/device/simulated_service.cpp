#include "tests/device/simulated_service.h"

#include <deque>
#include <fcntl.h>
#include <future>
#include <mutex>
#include <set>
#include <thread>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <fmt/format.h>

namespace forceshade::device::test {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using Tcp = asio::ip::tcp;
using ErrorCode = boost::system::error_code;
using Clock = std::chrono::steady_clock;

class Session;

/// What the sessions share; the mutex guards what other threads ask for.
struct Common {
    asio::io_context io{1};
    std::mutex mutex;
    ServiceScript script;
    std::vector<Received> received;
    unsigned connections = 0, farewells = 0;
    std::set<std::shared_ptr<Session>> sessions; // by the service's thread, under the mutex
    const Clock::time_point start = Clock::now();

    ServiceScript now() {
        const std::lock_guard lock(mutex);
        return script;
    }
    double seconds() const { return std::chrono::duration<double>(Clock::now() - start).count(); }
};

/// One connection, first HTTP, then perhaps a WebSocket.
class Session : public std::enable_shared_from_this<Session> {
public:
    Session(Common& common, Tcp::socket socket) : common_(common), line_(std::move(socket)) {}

    template <typename Then> auto keep(Then then) {
        return [self = shared_from_this(), then](auto&&... results) { then(results...); };
    }

    void begin() {
        if (common_.now().fault == Fault::no_http) {
            asio::async_write(line_.next_layer(), asio::buffer(noise_), keep([this](auto&&...) { close(); }));
            return;
        }
        http::async_read(line_.next_layer(), buffer_, request_, keep([this](const ErrorCode& error, std::size_t) {
                             if (error)
                                 return;
                             const bool upgrade = websocket::is_upgrade(request_);
                             upgrade&& common_.now().fault != Fault::no_websocket ? welcome() : reply();
                         }));
    }

    void close() {
        ErrorCode ignored;
        line_.next_layer().shutdown(Tcp::socket::shutdown_both, ignored);
        line_.next_layer().close(ignored);
    }

private:
    void reply() {
        const ServiceScript script = common_.now();
        const bool known = request_.target() == "/version" && !script.version.empty();
        response_.result(known ? http::status::ok : http::status::not_found);
        if (known)
            response_.body() =
                fmt::format(R"({{"project_name":"haply-inverse-service","project_version":"{}.0"}})", script.version);
        response_.prepare_payload();
        http::async_write(line_.next_layer(), response_, keep([this](auto&&...) { close(); }));
    }

    void welcome() {
        line_.async_accept(request_, keep([this](const ErrorCode& error) {
                               if (error)
                                   return;
                               {
                                   const std::lock_guard lock(common_.mutex);
                                   number_ = ++common_.connections;
                                   common_.sessions.insert(shared_from_this());
                               }
                               const ServiceScript script = common_.now();
                               if (script.fault != Fault::no_inventory)
                                   say(inventory(script));
                               hear();
                           }));
    }

    void say(std::string text) {
        outgoing_.push_back(std::move(text));
        if (outgoing_.size() == 1)
            write();
    }

    void write() {
        line_.async_write(asio::buffer(outgoing_.front()), keep([this](const ErrorCode& error, std::size_t) {
                              outgoing_.pop_front();
                              if (!error && !outgoing_.empty())
                                  write();
                          }));
    }

    void hear() {
        line_.async_read(incoming_, keep([this](const ErrorCode& error, std::size_t) {
                             if (error)
                                 return leave(error == websocket::error::closed);
                             const std::string text = beast::buffers_to_string(incoming_.data());
                             incoming_.consume(incoming_.size());
                             take(text);
                         }));
    }

    void leave(bool politely) {
        const std::lock_guard lock(common_.mutex);
        common_.farewells += politely ? 1 : 0;
        common_.sessions.erase(shared_from_this());
    }

    void take(const std::string& text) {
        const ServiceScript script = common_.now();
        glm::dvec3 force{0};
        if (auto received = read_command(text, script)) {
            received->time = Clock::now();
            received->connection = number_;
            force = received->force;
            const std::lock_guard lock(common_.mutex);
            common_.received.push_back(*received);
        }
        if (script.fault == Fault::closes) {
            close();
            return leave(false);
        }
        if (script.fault == Fault::unasked || script.fault == Fault::older)
            return say_too_much(script, force);
        if (script.fault == Fault::late)
            return say_later(script, force);
        if (script.fault != Fault::never_answers)
            say(answer(script, common_.seconds(), force));
        hear();
    }

    /// The answer, and after it one that nobody asked for.
    void say_too_much(const ServiceScript& script, const glm::dvec3& force) {
        say(answer(script, common_.seconds(), force));
        say(unasked_state(script, common_.seconds()));
        hear();
    }

    /// Reads the next command only then, as a service that is stuck.
    void say_later(const ServiceScript& script, const glm::dvec3& force) {
        later_.expires_after(script.delay);
        later_.async_wait(keep([this, script, force](const ErrorCode&) {
            say(answer(script, common_.seconds(), force));
            hear();
        }));
    }

    Common& common_;
    websocket::stream<Tcp::socket> line_;
    asio::steady_timer later_{common_.io};
    beast::flat_buffer buffer_, incoming_;
    http::request<http::string_body> request_;
    http::response<http::string_body> response_;
    std::deque<std::string> outgoing_;
    const std::string noise_ = "220 mail.example ready\r\n\r\n";
    unsigned number_ = 0;
};

} // namespace

class SimulatedService::Inside {
public:
    explicit Inside(ServiceScript script) {
        common_.script = std::move(script);
        listen();
        thread_ = std::thread([this] { common_.io.run(); });
    }

    ~Inside() {
        common_.io.stop();
        thread_.join();
    }

    void listen() {
        const Tcp::endpoint place(asio::ip::address_v4::loopback(), port_);
        acceptor_.open(place.protocol());
        keep_from_children(acceptor_);
        acceptor_.set_option(Tcp::acceptor::reuse_address(true));
        acceptor_.bind(place);
        acceptor_.listen();
        port_ = acceptor_.local_endpoint().port();
        accept();
    }

    /// A program that the test starts would hold it open.
    template <typename Socket> static void keep_from_children(Socket& socket) {
        ::fcntl(socket.native_handle(), F_SETFD, FD_CLOEXEC);
    }

    void accept() {
        acceptor_.async_accept([this](const ErrorCode& error, Tcp::socket socket) {
            if (error)
                return;
            ErrorCode ignored;
            socket.set_option(Tcp::no_delay(true), ignored);
            keep_from_children(socket);
            std::make_shared<Session>(common_, std::move(socket))->begin();
            accept();
        });
    }

    void go_away() {
        acceptor_.close();
        std::set<std::shared_ptr<Session>> sessions;
        {
            const std::lock_guard lock(common_.mutex);
            sessions.swap(common_.sessions);
        }
        for (const auto& session : sessions)
            session->close();
    }

    /// On the service's thread, waiting for its end.
    template <typename Act> void there(Act act) {
        std::promise<void> done;
        asio::post(common_.io, [&] {
            act();
            done.set_value();
        });
        done.get_future().wait();
    }

    Common common_;
    asio::executor_work_guard<asio::io_context::executor_type> working_{common_.io.get_executor()}; // while away too
    Tcp::acceptor acceptor_{common_.io};
    unsigned short port_ = 0;
    std::thread thread_;
};

SimulatedService::SimulatedService(ServiceScript script) : inside_(std::make_unique<Inside>(std::move(script))) {}
SimulatedService::~SimulatedService() = default;

std::string SimulatedService::url() const {
    return fmt::format("ws://127.0.0.1:{}", inside_->port_);
}

void SimulatedService::set(Fault fault) {
    const std::lock_guard lock(inside_->common_.mutex);
    inside_->common_.script.fault = fault;
}

void SimulatedService::set_devices(std::vector<std::string> devices) {
    const std::lock_guard lock(inside_->common_.mutex);
    inside_->common_.script.devices = std::move(devices);
}

void SimulatedService::set_grip(const std::string& grip) {
    const std::lock_guard lock(inside_->common_.mutex);
    inside_->common_.script.grip = grip;
}

void SimulatedService::go_away() {
    inside_->there([this] { inside_->go_away(); });
}

void SimulatedService::come_back() {
    inside_->there([this] { inside_->listen(); });
}

std::vector<Received> SimulatedService::received() const {
    const std::lock_guard lock(inside_->common_.mutex);
    return inside_->common_.received;
}

unsigned SimulatedService::connections() const {
    const std::lock_guard lock(inside_->common_.mutex);
    return inside_->common_.connections;
}

unsigned SimulatedService::open() const {
    const std::lock_guard lock(inside_->common_.mutex);
    return static_cast<unsigned>(inside_->common_.sessions.size());
}

unsigned SimulatedService::farewells() const {
    const std::lock_guard lock(inside_->common_.mutex);
    return inside_->common_.farewells;
}

} // namespace forceshade::device::test
