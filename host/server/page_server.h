// Pages for browsers on this machine alone: 127.0.0.1, each under a random token of its own, with a WebSocket.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace forceshade {

struct ServedPage {
    std::string name;        /* "participant": served as /TOKEN/participant; a picture under any page's token */
    std::string content;     /* HTML, or a picture that a page shows */
    bool one_client = false; /* a second browser is turned away */
    std::string type = "text/html; charset=utf-8";
};

/// What a page did. Texts are what its script sent.
struct PageEvent {
    enum class Kind { opened, closed, text };
    Kind kind;
    std::string page;
    std::string text;
};

/// Serves in threads of its own until it is destroyed. Requests with another token, another host or another origin are
/// refused.
class PageServer {
public:
    /// `port`: 0 for any that is free. `on_close`, if there is one, is called at once, in another thread, when a client
    /// of a page has gone. \throws UsageError if the port cannot be had.
    PageServer(std::vector<ServedPage> pages, std::uint16_t port,
               std::function<void(const std::string& page)> on_close = {});
    ~PageServer();

    /// "http://127.0.0.1:41237/4f0c.../participant"
    std::string address(const std::string& page) const;

    /// The oldest event that was not taken yet. From one thread.
    std::optional<PageEvent> next_event();

    /// To every client of a page, without waiting for any; one that takes nothing for a second is closed.
    void send(const std::string& page, const std::string& text);

    /// Whether a client of the page is connected.
    bool is_open(const std::string& page) const;

private:
    class Core;
    std::shared_ptr<Core> core_;
};

} // namespace forceshade
