// A headless Chromium with one page, driven by its DevTools protocol.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace forceshade::testing {

/// What the viewer tells, as JavaScript expressions.
inline constexpr const char* kSlice = "document.getElementById('slice-text').value";
inline constexpr const char* kPlace = "document.getElementById('read-place').textContent";

class Browser {
public:
    /// \throws std::runtime_error if there is no chromium or it does not answer within half a minute.
    Browser();
    ~Browser();

    /// A new page of that size (px) and colour scheme shows the file; `before` is run before any script of it.
    void open(const std::filesystem::path& file, unsigned width = 1200, bool dark = false,
              const std::string& before = {});
    /// Likewise what a server on this machine gives.
    void open_address(const std::string& address, unsigned width = 1200, bool dark = false,
                      const std::string& before = {});
    /// The value of a JavaScript expression. \throws std::runtime_error if it throws.
    nlohmann::json evaluate(const std::string& expression);
    std::string text(const std::string& expression) {
        return evaluate("String(" + expression + ")").get<std::string>();
    }
    /// Waits until the expression is true; false if it is not within 20 s.
    bool wait_for(const std::string& expression);

    /// In the middle of the first element that the selector names, brought into view; moved by dx, dy px.
    void click(const std::string& selector);
    void drag(const std::string& selector, double x, double y, double dx, double dy); /* from (x, y) of the element */
    /// Gives the first element that the selector names a value (an expression of the element `e`), as a reader does.
    void set(const std::string& selector, const std::string& value, const std::string& event = "change") {
        evaluate("(() => { const e = document.querySelector('" + selector + "'); e.value = " + value +
                 "; e.dispatchEvent(new Event('" + event + "')); })()");
    }
    /// "ArrowLeft", "PageUp", "Tab", "1".
    void press(const std::string& key);

    /// The PDF file that printing makes.
    std::string print();

    /// Errors and warnings of the console, exceptions, and what the page's policy refused, since open().
    const std::vector<std::string>& complaints() const;

private:
    nlohmann::json call(const std::string& method, nlohmann::json parameters = nlohmann::json::object());
    void mouse(const std::string& type, double x, double y, int buttons);

    struct State;
    std::unique_ptr<State> state_;
};

} // namespace forceshade::testing
