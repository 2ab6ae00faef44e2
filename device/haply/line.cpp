#include "device/haply/line.h"

#include "device/haply/line_trouble.h"

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

} // namespace forceshade::device
