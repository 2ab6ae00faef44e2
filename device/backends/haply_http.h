// Why a connection to the service failed, in words.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>

#include <boost/asio/error.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/core/error.hpp>
#include <boost/beast/http/error.hpp>
#include <boost/beast/websocket.hpp>
#include <boost/beast/websocket/error.hpp>
#include <boost/system/error_code.hpp>
#include <fmt/format.h>

#include "device/backends/haply.h"

namespace forceshade::device {

inline constexpr std::size_t kLongestMessage = std::size_t(1) << 20; // bytes; an inventory has some thousand

/// Of an operation that had `wait` s to end.
inline std::string trouble(const boost::system::error_code& error, double wait) {
    namespace websocket = boost::beast::websocket;
    if (error == boost::beast::error::timeout)
        return fmt::format("no answer within {} s", wait);
    if (error == boost::asio::error::connection_refused)
        return "connection refused: nothing listens there";
    if (error == websocket::error::message_too_big || error == websocket::error::buffer_overflow)
        return fmt::format("it sent a message of more than {} bytes", kLongestMessage);
    if (error == websocket::error::closed || error == boost::asio::error::eof ||
        error == boost::asio::error::connection_reset || error == boost::beast::http::error::end_of_stream)
        return "it closed the connection";
    if (error.category() == boost::beast::http::make_error_code(boost::beast::http::error::end_of_stream).category())
        return fmt::format("what answers there is no WebSocket ({})", error.message());
    return error.message();
}

// One connection to the service.

/// Handlers that are under way hold it, so that it outlives being replaced.
struct Line : std::enable_shared_from_this<Line> {
    using ErrorCode = boost::system::error_code;
    using Tcp = boost::asio::ip::tcp;

    explicit Line(boost::asio::io_context& io) : socket(io), resolver(io) {}

    /// Goes on until the service has told its inventory, however long that takes.
    void dial(const Address& address, std::function<void(const ErrorCode&, const std::string& inventory)> done);

    /// What was received, as it is.
    std::string take_text();

    int descriptor() { return socket.next_layer().socket().native_handle(); }

    /// At once; operations that are under way end with an error.
    void close();

    boost::beast::websocket::stream<boost::beast::tcp_stream> socket;
    Tcp::resolver resolver;
    boost::beast::flat_buffer received;
    std::string command;  // that is being written
    bool writing = false; // one at a time
};

} // namespace forceshade::device
