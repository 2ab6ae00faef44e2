#include "device/backends/haply.h"

#include <cctype>
#include <charconv>
#include <thread>

#include <fmt/format.h>

#include "device/backends/back_end.h"
#include "device/backends/haply_link.h"
#include "device/backends/haply_protocol.h"
#include "host/error.h"

namespace forceshade::device {

namespace {

constexpr std::string_view kScheme = "ws://";
constexpr std::string_view kDefaultPort = "10001";

[[noreturn]] void refuse(std::string_view url, std::string_view why) {
    throw UsageError(
        fmt::format("the Inverse Service's address '{}' {}: it looks like ws://localhost:10001", url, why));
}

std::string checked_port(std::string_view url, std::string_view port) {
    unsigned number = 0;
    const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), number);
    if (error != std::errc() || end != port.data() + port.size() || number == 0 || number > 65535)
        refuse(url, fmt::format("has the port '{}', which is none from 1 to 65535", port));
    return std::string(port);
}

} // namespace

std::string Address::host_field() const {
    return host.find(':') == std::string::npos ? fmt::format("{}:{}", host, port) : fmt::format("[{}]:{}", host, port);
}

Address parse_address(std::string_view url) {
    if (url.starts_with("wss://"))
        refuse(url, "asks for TLS, which the service does not speak");
    if (!url.starts_with(kScheme))
        refuse(url, "does not begin with ws://");
    std::string_view rest = url.substr(kScheme.size());
    const std::size_t slash = rest.find('/');
    Address address;
    address.path = slash == std::string_view::npos ? "/" : std::string(rest.substr(slash));
    rest = rest.substr(0, slash);
    std::string_view after; // the host
    if (rest.starts_with('[')) {
        const std::size_t close = rest.find(']');
        if (close == std::string_view::npos)
            refuse(url, "has a bracket that is not closed");
        address.host = rest.substr(1, close - 1);
        after = rest.substr(close + 1);
    } else {
        const std::size_t colon = rest.find(':');
        address.host = rest.substr(0, colon);
        after = colon == std::string_view::npos ? std::string_view() : rest.substr(colon);
    }
    if (address.host.empty())
        refuse(url, "names no host");
    if (address.host.find_first_of(" \t\r\n") != std::string::npos ||
        address.path.find_first_of(" \t\r\n") != std::string::npos)
        refuse(url, "has a blank in it");
    if (!after.empty() && after.front() != ':')
        refuse(url, "has something other than a port after its host");
    address.port = after.empty() ? std::string(kDefaultPort) : checked_port(url, after.substr(1));
    return address;
}

namespace {

void set(HaplyOptions& options, std::string_view key, std::string_view value) {
    using Dialect = HaplyOptions::Dialect;
    if (value.empty())
        throw UsageError(fmt::format("haply: '{}' has no value: ?device=04BA&dialect=values", key));
    if (key == "device")
        options.device_id = value;
    else if (key == "dialect" && value == "vector")
        options.dialect = Dialect::vector;
    else if (key == "dialect" && value == "values")
        options.dialect = Dialect::values;
    else if (key == "dialect")
        throw UsageError(fmt::format("haply: the dialect is vector or values, not '{}'", value));
    else
        throw UsageError(fmt::format("haply: unknown option '{}': there are device and dialect", key));
}

} // namespace

HaplyOptions parse_haply(std::string_view after_colon) {
    HaplyOptions options;
    const std::size_t mark = after_colon.find('?');
    const std::string_view url = after_colon.substr(0, mark);
    if (!url.empty())
        options.url = url;
    parse_address(options.url); // to complain now
    if (mark == std::string_view::npos)
        return options;
    std::string_view query = after_colon.substr(mark + 1);
    while (true) {
        const std::size_t end = query.find('&');
        const std::string_view pair = query.substr(0, end);
        const std::size_t equals = pair.find('=');
        set(options, pair.substr(0, equals), equals == std::string_view::npos ? "" : pair.substr(equals + 1));
        if (end == std::string_view::npos)
            return options;
        query = query.substr(end + 1);
    }
}

namespace {

/// N: what the Inverse3's data sheet promises over 80 % of its workspace (at its peak 10 N).
constexpr double kInverse3Force = 4;

/// m: from the device's origin, further than which its arm does not reach, however it is mounted. Its workspace, 460 mm
/// wide, 510 mm high and 230 mm deep, is no box.
constexpr double kReach = 0.6;
constexpr double kSilence = 0.045; /* s: a little less than the other thread waits for a force (link.cpp) */

constexpr std::string_view kHowToGet =
    "Install and start it (Haply Hub or the Inverse Service package, docs.haply.co; on Linux: "
    "systemctl start haply-inverse-service), or say where it is: --device haply:ws://HOST:PORT";

class HaplyBackEnd final : public BackEnd {
public:
    HaplyBackEnd(DeviceFacts facts, LinkOptions link, double patience)
        : facts_(std::move(facts)), link_(std::move(link)), stale_(static_cast<std::int64_t>(patience * 1e9)),
          exchange_(zero_frame(link_)), thread_([this] {
              raise_priority(kCarrierPriority);
              run_link(exchange_, link_);
          }) {}

    ~HaplyBackEnd() override {
        exchange_.stop();
        thread_.join();
    }

    const DeviceFacts& facts() const noexcept override { return facts_; }

    Reading read() noexcept override {
        const bool newer = exchange_.sighting.take(seen_);
        if (!seen_.good || (!newer && steady_now() - seen_.time > stale_))
            return {};
        return {newer ? Answer::fresh : Answer::held, seen_.position, false};
    }

    bool write(const glm::dvec3& force) noexcept override {
        if (exchange_.stopping)
            return false;
        exchange_.force.put(force);
        exchange_.wake();
        if (force == glm::dvec3(0) && exchange_.withheld == nullptr)
            exchange_.lately_withheld = nullptr;
        return exchange_.there && (withheld() == nullptr || force == glm::dvec3(0));
    }

    void halt() noexcept override { exchange_.stop(); }

    void rest() noexcept override {
        exchange_.resting = true;
        exchange_.wake();
    }

    const char* withheld() const noexcept override {
        const char* now = exchange_.withheld;
        return now != nullptr ? now : exchange_.lately_withheld.load();
    }

    const char* complaint() const noexcept override { return exchange_.complaint; }

private:
    static std::string zero_frame(const LinkOptions& link) {
        std::string command;
        write_command(command, link.dialect, link.device_id, glm::dvec3(0));
        return frame(command);
    }

    DeviceFacts facts_;
    LinkOptions link_;
    std::int64_t stale_; /* ns */
    Exchange exchange_;
    Sighting seen_;
    std::thread thread_;
};

std::string service_of(const HaplyFinding& finding) {
    return fmt::format("Inverse Service {}", finding.version.empty() ? "(version not told)" : finding.version);
}

std::string ids_of(const HaplyFinding& finding) {
    std::string ids;
    for (const HaplyDevice& device : finding.devices)
        ids += fmt::format("{}{}", ids.empty() ? "" : ", ", device.id);
    return ids;
}

const HaplyDevice& choose(const HaplyFinding& finding, const std::string& id) {
    if (finding.devices.empty())
        throw DeviceAbsent(
            fmt::format("the {} at {} lists no Inverse3: plug it in and switch it on (Haply Hub shows it)",
                        service_of(finding), finding.url));
    for (const HaplyDevice& device : finding.devices)
        if (device.id == id || (id.empty() && finding.devices.size() == 1))
            return device;
    if (!id.empty())
        throw DeviceAbsent(fmt::format("the {} at {} lists no device {}; it lists {}", service_of(finding), finding.url,
                                       id, ids_of(finding)));
    throw UsageError(fmt::format("the {} at {} lists several devices: {}; choose one: --device 'haply:{}?device={}'",
                                 service_of(finding), finding.url, ids_of(finding), finding.url,
                                 finding.devices.front().id));
}

DeviceFacts facts_of(const HaplyFinding& finding, const HaplyDevice& device) {
    DeviceFacts facts;
    std::string type = device.type.empty() ? "inverse3" : device.type;
    if (type == "inverse3")
        facts.max_force = kInverse3Force;
    facts.silence = kSilence;
    facts.low = glm::dvec3(-kReach);
    facts.high = glm::dvec3(kReach);
    type.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(type.front())));
    facts.name = fmt::format("{} {}", type, device.id);
    facts.software = service_of(finding);
    return facts;
}

std::chrono::milliseconds milliseconds_of(double seconds) {
    return std::chrono::milliseconds(static_cast<std::int64_t>(seconds * 1e3));
}

} // namespace

std::unique_ptr<BackEnd> open_haply(const HaplyOptions& options) {
    const HaplyFinding finding = look_for_haply(options.url, options.wait);
    if (!finding.problem.empty())
        throw DeviceAbsent(fmt::format("no Inverse Service at {}: {}. {}", finding.url, finding.problem, kHowToGet));
    const HaplyDevice& device = choose(finding, options.device_id);
    if (!parse_basis(device.basis))
        throw DeviceAbsent(fmt::format("the {} at {} speaks of device {} in the basis '{}', which is no permutation of "
                                       "X, Y and Z: set another one in Haply Hub",
                                       service_of(finding), finding.url, device.id, device.basis));
    LinkOptions link;
    link.address = parse_address(options.url);
    link.device_id = device.id;
    link.dialect = options.dialect == HaplyOptions::Dialect::by_version ? dialect_of(finding.version) : options.dialect;
    link.wait = milliseconds_of(options.wait);
    link.patience = milliseconds_of(options.patience);
    return std::make_unique<HaplyBackEnd>(facts_of(finding, device), std::move(link), options.patience);
}

} // namespace forceshade::device
