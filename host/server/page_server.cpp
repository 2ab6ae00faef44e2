#include "host/server/page_server.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>
#include <poll.h>
#include <pthread.h>
#include <random>
#include <sys/socket.h>
#include <system_error>
#include <thread>
#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <fmt/format.h>

#include "host/arenas.h"
#include "host/clock.h"
#include "host/error.h"
#include "host/program.h"

namespace forceshade {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using Tcp = asio::ip::tcp;
using WebSocket = beast::websocket::stream<Tcp::socket>;
using Request = http::request<http::string_body>;

constexpr std::size_t kLongestText = 16384;                 // bytes that a page may send at once
constexpr std::size_t kMostEvents = 1000;                   // that wait
constexpr auto kPatience = std::chrono::seconds(1);         // with a browser that takes nothing
constexpr auto kLastWords = std::chrono::milliseconds(200); // for what was sent just before the end
constexpr auto kRequestPatience = std::chrono::seconds(2);  // for a whole request
constexpr std::size_t kPiece = 4096;                        // bytes of one, at once
constexpr int kMostConnections = 32;
constexpr std::size_t kStack = 256 * 1024; // bytes of a thread's: where memory is locked, the usual 8 MB are, too

std::string random_token() {
    std::random_device source;
    std::string token;
    for (int i = 0; i < 4; ++i)
        token += fmt::format("{:08x}", source());
    return token;
}

// A thread with a small stack.
class SmallThread {
public:
    SmallThread() = default;
    /// \throws std::system_error
    explicit SmallThread(std::function<void()> run) {
        pthread_attr_t attributes;
        ::pthread_attr_init(&attributes);
        ::pthread_attr_setstacksize(&attributes, kStack);
        auto task = std::make_unique<std::function<void()>>(std::move(run));
        const auto begin = [](void* given) -> void* {
            const std::unique_ptr<std::function<void()>> taken(static_cast<std::function<void()>*>(given));
            (*taken)();
            return nullptr;
        };
        const int error = ::pthread_create(&id_, &attributes, begin, task.get());
        ::pthread_attr_destroy(&attributes);
        if (error != 0)
            throw std::system_error(error, std::generic_category());
        static_cast<void>(task.release());
        joinable_ = true;
    }
    void join() {
        if (std::exchange(joinable_, false))
            ::pthread_join(id_, nullptr);
    }
    void detach() {
        if (std::exchange(joinable_, false))
            ::pthread_detach(id_);
    }

private:
    pthread_t id_{};
    bool joinable_ = false;
};

bool is_html(const ServedPage& page) {
    return page.type.starts_with("text/html");
}

// Scripts run by a number that only this answer has; what is no page runs none.
std::string policy_of(const ServedPage& page, const std::string& nonce) {
    return is_html(page) ? fmt::format("default-src 'none'; style-src 'unsafe-inline'; script-src 'nonce-{}'; img-src "
                                       "'self' data:; connect-src 'self'; base-uri 'none'; frame-ancestors 'none'",
                                       nonce)
                         : "default-src 'none'; style-src 'unsafe-inline'; sandbox";
}

std::string with_nonce(std::string html, const std::string& nonce) {
    constexpr std::string_view kScript = "<script";
    const std::string attribute = fmt::format(" nonce=\"{}\"", nonce);
    for (std::size_t at = html.find(kScript); at != std::string::npos; at = html.find(kScript, at + 1))
        html.insert(at + kScript.size(), attribute);
    return html;
}

} // namespace

class PageServer::Core : public std::enable_shared_from_this<Core> {
public:
    Core(std::vector<ServedPage> pages, std::function<void(const std::string&)> on_close)
        : pages_(std::move(pages)), on_close_(std::move(on_close)), acceptor_(io_) {
        for (const ServedPage& page : pages_)
            if (is_html(page))
                tokens_.emplace(page.name, random_token());
    }

    void listen(std::uint16_t port) {
        beast::error_code error;
        const Tcp::endpoint here(asio::ip::make_address("127.0.0.1"), port);
        acceptor_.open(here.protocol(), error);
        acceptor_.set_option(asio::socket_base::reuse_address(true), error);
        acceptor_.bind(here, error);
        if (!error)
            acceptor_.listen(16, error);
        if (error)
            throw UsageError("--port {}: cannot be had ({}); choose another, or none", port, error.message());
        port_ = acceptor_.local_endpoint().port();
        accepting_ = std::thread([self = shared_from_this()] { self->accept(); });
    }

    void stop() {
        const Clock::time_point end = Clock::now() + kLastWords;
        while (is_writing() && Clock::now() < end)
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
        {
            const std::lock_guard lock(mutex_);
            stopped_ = true;
            for (const auto& client : clients_)
                client->hang_up();
        }
        ::shutdown(acceptor_.native_handle(), SHUT_RDWR);
        accepting_.join();
        // Clients' threads hold the core until their reads have failed.
        for (int i = 0; i < 200 && running_ > 0; ++i)
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }

    std::string address(const std::string& page) const {
        return fmt::format("http://127.0.0.1:{}/{}/{}", port_, tokens_.at(page), page);
    }

    std::optional<PageEvent> next_event() {
        const std::lock_guard lock(mutex_);
        if (events_.empty())
            return std::nullopt;
        PageEvent event = std::move(events_.front());
        events_.pop_front();
        return event;
    }

    void send(const std::string& page, const std::string& text) {
        std::vector<std::shared_ptr<Client>> to;
        {
            const std::lock_guard lock(mutex_);
            std::ranges::copy_if(clients_, std::back_inserter(to),
                                 [&](const auto& client) { return client->page == page; });
        }
        for (const auto& client : to)
            client->put(text);
    }

    bool is_open(const std::string& page) const {
        const std::lock_guard lock(mutex_);
        return std::ranges::any_of(clients_, [&](const auto& client) { return client->page == page; });
    }

private:
    struct Client {
        Client(Tcp::socket raw, std::string name) : socket(std::move(raw)), page(std::move(name)) {}

        // To the socket goes what a thread of the client's own writes: Asio waits for room there for ever, whatever
        // timeout the socket has.
        void put(const std::string& text) {
            const std::lock_guard lock(mutex);
            if (texts.empty())
                moved = Clock::now();
            else if (Clock::now() - moved > kPatience)
                return hang_up();
            texts.push_back(text);
            wake.notify_one();
        }
        void write() {
            std::unique_lock lock(mutex);
            while (true) {
                wake.wait(lock, [this] { return gone || !texts.empty(); });
                if (gone)
                    return;
                const std::string& text = texts.front(); // stays where it is while others are put behind it
                lock.unlock();
                beast::error_code error;
                socket.write(asio::buffer(text), error);
                lock.lock();
                if (error)
                    return hang_up();
                texts.pop_front();
                moved = Clock::now();
            }
        }
        // Ends what reads and writes there.
        void hang_up() { ::shutdown(socket.next_layer().native_handle(), SHUT_RDWR); }

        WebSocket socket;
        const std::string page;
        std::mutex mutex; // of what follows
        std::condition_variable wake;
        std::deque<std::string> texts; // still to be written
        Clock::time_point moved{};     // when one was written, or the first was put
        bool gone = false;
    };

    bool is_writing() const {
        const std::lock_guard lock(mutex_);
        return std::ranges::any_of(clients_, [](const auto& client) {
            const std::lock_guard lock_client(client->mutex);
            return !client->texts.empty();
        });
    }

    void accept() {
        const QuietSignals quiet;
        while (!stopped_) {
            beast::error_code error;
            Tcp::socket socket(io_);
            acceptor_.accept(socket, error);
            if (error) {
                std::this_thread::sleep_for(std::chrono::milliseconds(10)); // of too many open files, say
                continue;
            }
            socket.set_option(Tcp::no_delay(true), error);
            if (running_ >= kMostConnections)
                continue; // closed
            ++running_;
            try {
                SmallThread([self = shared_from_this(), one = std::make_shared<Tcp::socket>(std::move(socket))] {
                    self->serve(std::move(*one));
                    --self->running_;
                }).detach();
            } catch (const std::system_error&) { // there is no thread, or no locked memory, for another browser
                --running_;
            }
        }
    }

    void serve(Tcp::socket socket) {
        beast::flat_buffer buffer;
        beast::error_code error;
        http::request_parser<http::string_body> parser;
        parser.body_limit(kLongestText);
        for (const Clock::time_point end = Clock::now() + kRequestPatience; !parser.is_done();) {
            const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
            pollfd asked{socket.native_handle(), POLLIN, 0};
            if (left <= 0 || ::poll(&asked, 1, static_cast<int>(left)) <= 0)
                return;
            buffer.commit(socket.read_some(buffer.prepare(kPiece), error)); // http::read would wait for the rest
            if (!error)
                buffer.consume(parser.put(buffer.data(), error));
            if (error && error != http::error::need_more)
                return;
        }
        const Request request = parser.release();
        const ServedPage* page = page_of(request);
        if (page == nullptr)
            return answer(socket, request, http::status::not_found,
                          {"", "There is nothing here.\n", false, "text/plain"});
        if (!beast::websocket::is_upgrade(request))
            return answer(socket, request, http::status::ok, *page);
        talk(std::make_shared<Client>(std::move(socket), page->name), request, page->one_client);
    }

    // Null: a request that does not come from one of our own pages.
    const ServedPage* page_of(const Request& request) const {
        const std::string host = std::string(request[http::field::host]), origin(request[http::field::origin]);
        const auto is_here = [&](const std::string& name) { return host == fmt::format("{}:{}", name, port_); };
        if (!is_here("127.0.0.1") && !is_here("localhost"))
            return nullptr;
        if (!origin.empty() && origin != "http://" + host)
            return nullptr;
        for (const ServedPage& page : pages_)
            for (const auto& [name, token] : tokens_) // pictures are every page's
                if ((name == page.name || !is_html(page)) &&
                    request.target() == fmt::format("/{}/{}", token, page.name))
                    return &page;
        return nullptr;
    }

    static void answer(Tcp::socket& socket, const Request& request, http::status status, const ServedPage& page) {
        const std::string nonce = random_token();
        http::response<http::string_body> response(status, request.version());
        response.set(http::field::content_type, page.type);
        response.set(http::field::cache_control, "no-store");
        response.set("Referrer-Policy", "no-referrer");
        response.set("X-Content-Type-Options", "nosniff");
        response.set("Content-Security-Policy", policy_of(page, nonce));
        response.keep_alive(false);
        response.body() = is_html(page) ? with_nonce(page.content, nonce) : page.content;
        response.prepare_payload();
        beast::error_code error;
        http::write(socket, response, error);
        socket.shutdown(Tcp::socket::shutdown_send, error);
    }

    void talk(const std::shared_ptr<Client>& client, const Request& request, bool alone) {
        beast::error_code error;
        client->socket.read_message_max(kLongestText);
        client->socket.accept(request, error);
        if (error)
            return;
        if (!enter(client, alone)) {
            client->socket.write(asio::buffer(std::string(R"({"type":"taken"})")), error);
            client->socket.close(beast::websocket::close_code::normal, error);
            return;
        }
        SmallThread writing;
        try {
            writing = SmallThread([client] { client->write(); });
        } catch (const std::system_error&) { // as in accept()
            client->hang_up();
        }
        beast::flat_buffer buffer;
        while (true) {
            client->socket.read(buffer, error);
            if (error)
                break;
            add({PageEvent::Kind::text, client->page, beast::buffers_to_string(buffer.data())});
            buffer.clear();
        }
        {
            const std::lock_guard lock(client->mutex);
            client->gone = true;
        }
        client->hang_up();
        client->wake.notify_one();
        writing.join();
        {
            const std::lock_guard lock(mutex_);
            std::erase(clients_, client);
            if (stopped_)
                return;
        }
        if (on_close_)
            on_close_(client->page);
        add({PageEvent::Kind::closed, client->page, {}});
    }

    bool enter(const std::shared_ptr<Client>& client, bool alone) {
        const std::lock_guard lock(mutex_);
        if (stopped_ ||
            (alone && std::ranges::any_of(clients_, [&](const auto& one) { return one->page == client->page; })))
            return false;
        clients_.push_back(client);
        events_.push_back({PageEvent::Kind::opened, client->page, {}});
        return true;
    }

    void add(PageEvent event) {
        const std::lock_guard lock(mutex_);
        if (events_.size() < kMostEvents)
            events_.push_back(std::move(event));
    }

    const std::vector<ServedPage> pages_;
    const std::function<void(const std::string&)> on_close_;
    std::map<std::string, std::string> tokens_; // by page: who has one page's address does not know another's
    asio::io_context io_;
    Tcp::acceptor acceptor_;
    std::uint16_t port_ = 0;
    std::thread accepting_;
    std::atomic<int> running_ = 0;
    std::atomic<bool> stopped_ = false;
    mutable std::mutex mutex_; // of what follows
    std::vector<std::shared_ptr<Client>> clients_;
    std::deque<PageEvent> events_;
};

PageServer::PageServer(std::vector<ServedPage> pages, std::uint16_t port,
                       std::function<void(const std::string& page)> on_close)
    : core_(std::make_shared<Core>(std::move(pages), std::move(on_close))) {
    const QuietSignals quiet;
    share_arenas(); // before the first of many threads
    core_->listen(port);
}

PageServer::~PageServer() {
    core_->stop();
}

std::string PageServer::address(const std::string& page) const {
    return core_->address(page);
}
std::optional<PageEvent> PageServer::next_event() {
    return core_->next_event();
}
void PageServer::send(const std::string& page, const std::string& text) {
    core_->send(page, text);
}
bool PageServer::is_open(const std::string& page) const {
    return core_->is_open(page);
}

} // namespace forceshade
