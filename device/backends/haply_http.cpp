#include "device/backends/haply_http.h"

#include <chrono>

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <fmt/format.h>

#include "device/backends/haply.h"
#include "device/backends/haply_protocol.h"

namespace forceshade::device {

void Line::dial(const Address& address, std::function<void(const ErrorCode&, const std::string& inventory)> done) {
    const auto self = shared_from_this();
    const auto told = [self, done](const ErrorCode& error, std::size_t) {
        done(error, error ? "" : self->take_text());
    };
    const auto greeted = [self, done, told](const ErrorCode& error) {
        if (error)
            return done(error, {});
        self->socket.async_read(self->received, told);
    };
    const auto connected = [self, done, greeted, address](const ErrorCode& error, const Tcp::endpoint&) {
        if (error)
            return done(error, {});
        ErrorCode ignored;
        self->socket.next_layer().socket().set_option(Tcp::no_delay(true), ignored);
        self->socket.async_handshake(address.host_field(), address.path, greeted);
    };
    socket.read_message_max(kLongestMessage);
    resolver.async_resolve(address.host, address.port,
                           [self, done, connected](const ErrorCode& error, const Tcp::resolver::results_type& places) {
                               if (error)
                                   return done(error, {});
                               self->socket.next_layer().async_connect(places, connected);
                           });
}

std::string Line::take_text() {
    std::string text(static_cast<const char*>(received.data().data()), received.size());
    received.consume(received.size());
    return text;
}

void Line::close() {
    ErrorCode ignored;
    resolver.cancel();
    Tcp::socket& tcp = socket.next_layer().socket();
    tcp.shutdown(Tcp::socket::shutdown_both, ignored);
    tcp.close(ignored);
}

// What answers at an address: asked step by step, each with its own time limit, sending no command.

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using Tcp = asio::ip::tcp;
using ErrorCode = boost::system::error_code;

class Look {
public:
    Look(const Address& address, double wait)
        : address_(address), wait_(std::chrono::milliseconds(static_cast<std::int64_t>(wait * 1000))), wait_s_(wait) {}

    HaplyFinding find(std::string url) {
        HaplyFinding finding;
        finding.url = std::move(url);
        const ErrorCode reached = ask_version(finding.version);
        if (reached) {
            finding.problem = trouble(reached, wait_s_);
            return finding;
        }
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

    ErrorCode connect(beast::tcp_stream& stream) {
        Tcp::resolver resolver(io_);
        Tcp::resolver::results_type places;
        const ErrorCode resolved = step([&](auto done) {
            resolver.async_resolve(address_.host, address_.port, [&places, done](const ErrorCode& error, auto found) {
                places = found;
                done(error);
            });
        });
        if (resolved)
            return resolved;
        stream.expires_after(wait_);
        return step([&](auto done) { stream.async_connect(places, done); });
    }

    /// Only that nobody is there is an error: a service may keep its version to itself.
    ErrorCode ask_version(std::string& version) {
        beast::tcp_stream stream(io_);
        if (const ErrorCode error = connect(stream))
            return error;
        http::request<http::empty_body> request{http::verb::get, "/version", 11};
        request.set(http::field::host, address_.host_field());
        request.set(http::field::connection, "close");
        beast::flat_buffer buffer(kLongestMessage);
        http::response<http::string_body> response;
        stream.expires_after(wait_);
        ErrorCode error = step([&](auto done) { http::async_write(stream, request, done); });
        if (!error)
            error = step([&](auto done) { http::async_read(stream, buffer, response, done); });
        if (!error && response.result() == http::status::ok)
            version = read_version(response.body());
        return {};
    }

    void ask_inventory(HaplyFinding& finding) {
        websocket::stream<beast::tcp_stream> line(io_);
        line.read_message_max(kLongestMessage);
        ErrorCode error = connect(line.next_layer());
        websocket::response_type response;
        if (!error) {
            line.next_layer().expires_after(wait_);
            error =
                step([&](auto done) { line.async_handshake(response, address_.host_field(), address_.path, done); });
        }
        if (error == websocket::error::upgrade_declined) {
            finding.problem = fmt::format("an HTTP server answers there, but not as a WebSocket (status {})",
                                          static_cast<unsigned>(response.result_int()));
            return;
        }
        beast::flat_buffer buffer;
        if (!error) {
            line.next_layer().expires_after(wait_);
            error = step([&](auto done) { line.async_read(buffer, done); });
        }
        if (error) {
            finding.problem = trouble(error, wait_s_);
            return;
        }
        const auto text = static_cast<const char*>(buffer.data().data());
        if (auto devices = read_inventory({text, buffer.size()}))
            finding.devices = std::move(*devices);
        else
            finding.problem = "what answers there tells no inventory of devices: it is not the Inverse Service 3.x";
        line.next_layer().expires_after(std::min<std::chrono::milliseconds>(wait_, std::chrono::milliseconds(200)));
        step([&](auto done) { line.async_close(websocket::close_code::normal, done); });
    }

    const Address& address_;
    std::chrono::milliseconds wait_;
    double wait_s_;
    asio::io_context io_{1};
};

} // namespace

HaplyFinding look_for_haply(const std::string& url, double wait) {
    return Look(parse_address(url), wait).find(url);
}

} // namespace forceshade::device
