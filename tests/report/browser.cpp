#include "tests/report/browser.h"

#include <chrono>
#include <fstream>
#include <map>
#include <stdexcept>
#include <thread>

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <openssl/evp.h>
#include <signal.h>
#include <sys/socket.h>

#include "tests/e2e/process.h"
#include "tests/io/folder.h"

namespace forceshade::testing {
namespace {

using Json = nlohmann::json;
using namespace std::chrono_literals;
namespace net = boost::asio;
namespace websocket = boost::beast::websocket;

constexpr const char* kProgram = "/usr/bin/chromium";

Launch launch(const std::filesystem::path& profile) {
    if (!std::filesystem::exists(kProgram))
        throw std::runtime_error("there is no /usr/bin/chromium: install the package chromium");
    Launch launch;
    launch.program = "/bin/sh"; // it is a script
    launch.arguments = {kProgram,
                        "--headless=new",
                        "--no-sandbox",
                        "--disable-gpu",
                        "--enable-unsafe-swiftshader", // WebGL without a GPU
                        "--hide-scrollbars",
                        "--no-first-run",
                        "--disable-background-networking",
                        "--disable-dev-shm-usage",
                        "--disable-sync",
                        "--remote-debugging-port=0",
                        "--user-data-dir=" + profile.string(),
                        "about:blank"};
    launch.environment["HOME"] = profile.string();
    launch.timeout = 900;                                 // it serves the tests of a whole suite
    launch.environment["VK_LOADER_DRIVERS_SELECT"] = "*"; // its own software device draws WebGL
    return launch;
}

// Chromium writes its port and its own address there.
std::pair<std::string, std::string> debugging_address(const std::filesystem::path& profile) {
    for (int tries = 0; tries < 600; ++tries) {
        std::ifstream file(profile / "DevToolsActivePort");
        std::string port, path;
        if (std::getline(file, port) && std::getline(file, path))
            return {port, path};
        std::this_thread::sleep_for(50ms);
    }
    throw std::runtime_error("chromium did not start");
}

std::string bytes_of(const std::string& base64) {
    std::string bytes(base64.size(), '\0');
    const int length =
        EVP_DecodeBlock(reinterpret_cast<unsigned char*>(bytes.data()),
                        reinterpret_cast<const unsigned char*>(base64.data()), static_cast<int>(base64.size()));
    bytes.resize(static_cast<std::size_t>(std::max(length, 0)));
    return bytes;
}

} // namespace

struct Browser::State {
    Folder profile;
    Process process{launch(profile.path())};
    net::io_context context;
    websocket::stream<net::ip::tcp::socket> socket{context};
    int last_call = 0;
    std::string target, session; /* of the page */
    std::vector<std::string> complaints;

    void connect();
    Json receive();
    void note(const Json& event);
};

void Browser::State::connect() {
    const auto [port, path] = debugging_address(profile.path());
    net::ip::tcp::resolver resolver(context);
    net::connect(socket.next_layer(), resolver.resolve("127.0.0.1", port));
    const timeval limit{30, 0}; // of any answer
    ::setsockopt(socket.next_layer().native_handle(), SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
    socket.read_message_max(256u << 20);
    socket.handshake("127.0.0.1:" + port, path);
}

Json Browser::State::receive() {
    boost::beast::flat_buffer buffer;
    socket.read(buffer);
    return Json::parse(boost::beast::buffers_to_string(buffer.data()));
}

void Browser::State::note(const Json& event) {
    const std::string method = event.value("method", "");
    if (event.value("sessionId", "") != session)
        return;
    const Json& parameters = event["params"];
    if (parameters.dump().find("GPU stall due to ReadPixels") != std::string::npos)
        return; // WebGL without a GPU is slow to be looked at
    if (method == "Runtime.exceptionThrown")
        complaints.push_back(parameters["exceptionDetails"].dump());
    else if (method == "Log.entryAdded" && parameters["entry"]["level"] != "info" &&
             parameters["entry"]["level"] != "verbose")
        complaints.push_back(parameters["entry"].dump());
    else if (method == "Runtime.consoleAPICalled" &&
             (parameters["type"] == "error" || parameters["type"] == "warning" || parameters["type"] == "assert"))
        complaints.push_back(parameters["args"].dump());
}

Browser::Browser() : state_(std::make_unique<State>()) {
    state_->connect();
}

Browser::~Browser() {
    try {
        call("Browser.close");
    } catch (const std::exception&) {
        state_->process.send(SIGTERM);
    }
    state_->process.wait(); // nothing is written to its folder any more
}

Json Browser::call(const std::string& method, Json parameters) {
    Json message{{"id", ++state_->last_call}, {"method", method}, {"params", std::move(parameters)}};
    if (!state_->session.empty() && !method.starts_with("Target.") && !method.starts_with("Browser."))
        message["sessionId"] = state_->session;
    state_->socket.write(net::buffer(message.dump()));
    for (;;) {
        const Json answer = state_->receive();
        if (!answer.contains("id"))
            state_->note(answer);
        else if (answer["id"] == state_->last_call && answer.contains("error"))
            throw std::runtime_error(method + ": " + answer["error"].dump());
        else if (answer["id"] == state_->last_call)
            return answer["result"];
    }
}

void Browser::open(const std::filesystem::path& file, unsigned width, bool dark, const std::string& before) {
    open_address("file://" + file.string(), width, dark, before);
}

void Browser::open_address(const std::string& address, unsigned width, bool dark, const std::string& before) {
    if (!state_->target.empty())
        call("Target.closeTarget", {{"targetId", state_->target}});
    state_->session.clear();
    state_->complaints.clear();
    state_->target = call("Target.createTarget", {{"url", "about:blank"}})["targetId"];
    state_->session = call("Target.attachToTarget", {{"targetId", state_->target}, {"flatten", true}})["sessionId"];
    for (const char* domain : {"Runtime.enable", "Log.enable", "Page.enable"})
        call(domain);
    call("Emulation.setDeviceMetricsOverride",
         {{"width", width}, {"height", 900}, {"deviceScaleFactor", 1}, {"mobile", false}});
    call("Emulation.setEmulatedMedia",
         {{"features", {{{"name", "prefers-color-scheme"}, {"value", dark ? "dark" : "light"}}}}});
    if (!before.empty())
        call("Page.addScriptToEvaluateOnNewDocument", {{"source", before}});
    call("Page.navigate", {{"url", address}});
    if (!wait_for("location.protocol !== 'about:' && document.readyState === 'complete'"))
        throw std::runtime_error("the page does not load");
}

Json Browser::evaluate(const std::string& expression) {
    const Json result =
        call("Runtime.evaluate", {{"expression", expression}, {"returnByValue", true}, {"awaitPromise", true}});
    if (result.contains("exceptionDetails"))
        throw std::runtime_error(expression + ": " + result["exceptionDetails"].dump());
    return result["result"].contains("value") ? result["result"]["value"] : Json();
}

bool Browser::wait_for(const std::string& expression) {
    for (int tries = 0; tries < 400; ++tries) {
        if (evaluate(expression) == true)
            return true;
        std::this_thread::sleep_for(50ms);
    }
    return false;
}

void Browser::mouse(const std::string& type, double x, double y, int buttons) {
    call("Input.dispatchMouseEvent", {{"type", type},
                                      {"x", x},
                                      {"y", y},
                                      {"button", type == "mouseMoved" && !buttons ? "none" : "left"},
                                      {"buttons", buttons},
                                      {"clickCount", type == "mouseMoved" ? 0 : 1}});
}

void Browser::drag(const std::string& selector, double x, double y, double dx, double dy) {
    const Json box = evaluate("(() => { const e = document.querySelector('" + selector +
                              "'); e.scrollIntoView({block: 'center'}); const b = e.getBoundingClientRect(); "
                              "return [b.x, b.y, b.width, b.height]; })()");
    const double left = box[0].get<double>() + x, top = box[1].get<double>() + y;
    mouse("mouseMoved", left, top, 0);
    mouse("mousePressed", left, top, 1);
    if (dx != 0 || dy != 0) {
        mouse("mouseMoved", left + dx / 2, top + dy / 2, 1);
        mouse("mouseMoved", left + dx, top + dy, 1);
    }
    mouse("mouseReleased", left + dx, top + dy, 0);
}

void Browser::click(const std::string& selector) {
    const Json size = evaluate("(() => { const b = document.querySelector('" + selector +
                               "').getBoundingClientRect(); return [b.width / 2, b.height / 2]; })()");
    drag(selector, size[0], size[1], 0, 0);
}

void Browser::press(const std::string& key) {
    static const std::map<std::string, int> kCodes{
        {"ArrowLeft", 37}, {"ArrowUp", 38},  {"ArrowRight", 39}, {"ArrowDown", 40}, {"Enter", 13},
        {"PageUp", 33},    {"PageDown", 34}, {"Tab", 9},         {"1", 49},         {"2", 50},
        {"3", 51},         {"4", 52},        {" ", 32},          {"p", 80},         {"r", 82}};
    for (const char* type : {"keyDown", "keyUp"})
        call("Input.dispatchKeyEvent", {{"type", type},
                                        {"key", key},
                                        {"code", key.size() == 1 ? "Digit" + key : key},
                                        {"windowsVirtualKeyCode", kCodes.at(key)}});
}

std::string Browser::print() {
    return bytes_of(call("Page.printToPDF", {{"printBackground", true}})["data"]);
}

const std::vector<std::string>& Browser::complaints() const {
    return state_->complaints;
}

} // namespace forceshade::testing
