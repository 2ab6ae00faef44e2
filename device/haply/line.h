// One connection to the service.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>

#include "device/haply/address.h"

namespace forceshade::device {

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
