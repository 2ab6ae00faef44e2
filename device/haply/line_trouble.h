// Why a connection to the service failed, in words.
#pragma once

#include <cstddef>
#include <string>

#include <boost/asio/error.hpp>
#include <boost/beast/core/error.hpp>
#include <boost/beast/http/error.hpp>
#include <boost/beast/websocket/error.hpp>
#include <boost/system/error_code.hpp>
#include <fmt/format.h>

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

} // namespace forceshade::device
