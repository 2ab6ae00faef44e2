#include "tests/device/simulated_service.h"

#include <future>
#include <thread>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/post.hpp>

#include "tests/device/simulated_session.h"

namespace forceshade::device::test {

class SimulatedService::Inside {
public:
    explicit Inside(ServiceScript script) {
        port_ = script.port;
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
        acceptor_.set_option(Tcp::acceptor::reuse_address(true));
        acceptor_.bind(place);
        acceptor_.listen();
        port_ = acceptor_.local_endpoint().port();
        accept();
    }

    void accept() {
        acceptor_.async_accept([this](const ErrorCode& error, Tcp::socket socket) {
            if (error)
                return;
            ErrorCode ignored;
            socket.set_option(Tcp::no_delay(true), ignored);
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

unsigned short SimulatedService::port() const {
    return inside_->port_;
}
std::string SimulatedService::url() const {
    return fmt::format("ws://127.0.0.1:{}", port());
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
