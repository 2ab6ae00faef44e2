#include "device/backends/haply.h"

#include <cctype>
#include <thread>

#include <fmt/format.h>

#include "device/backends/back_end.h"
#include "host/error.h"

namespace forceshade::device {

namespace {

/// N: stated by the Inverse3's data sheet over 80 % of its workspace (at its peak 10 N).
constexpr double kInverse3Force = 4;

/// m: its arm's largest reach from the device's origin, however it is mounted. Its workspace, 460 mm wide, 510 mm high
/// and 230 mm deep, is not a box.
constexpr double kReach = 0.6;
constexpr double kHaplySilence = 0.045; /* s: a little less than the other thread waits for a force (haply_link.cpp) */

constexpr std::string_view kHowToGet =
    "Install and start it (Haply Hub or the Inverse Service package, docs.haply.co; on Linux: "
    "systemctl start haply-inverse-service), or say where it is: --device haply:ws://HOST:PORT";

class HaplyBackEnd final : public BackEnd {
public:
    HaplyBackEnd(DeviceFacts facts, HaplyOptions options)
        : facts_(std::move(facts)), options_(std::move(options)), exchange_(zero_frame(options_)), thread_([this] {
              raise_priority(kCarrierPriority);
              run_link(exchange_, options_);
          }) {}

    ~HaplyBackEnd() override {
        exchange_.stop();
        thread_.join();
    }

    const DeviceFacts& facts() const noexcept override { return facts_; }

    Reading read() noexcept override {
        const bool newer = exchange_.measurement.take(seen_);
        if (!seen_.good || (!newer && now() - seen_.time > stale_))
            return {};
        return {newer ? Answer::fresh : Answer::repeated, seen_.position, false, seen_.buttons};
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
        const char* why = exchange_.withheld;
        return why != nullptr ? why : exchange_.lately_withheld.load();
    }

    const char* error_text() const noexcept override { return exchange_.error_text; }

private:
    static std::string zero_frame(const HaplyOptions& options) {
        std::string command;
        write_command(command, options.dialect, options.device_id, glm::dvec3(0));
        return frame(command);
    }

    DeviceFacts facts_;
    const HaplyOptions options_;                                                    // with a device and a dialect
    const std::int64_t stale_ = static_cast<std::int64_t>(options_.patience * 1e9); /* ns */
    Exchange exchange_;
    Measurement seen_; // last
    std::thread thread_;
};

std::string service_of(const HaplyFinding& finding) {
    return fmt::format("Inverse Service {}", finding.version.empty() ? "(version unknown)" : finding.version);
}

const HaplyDevice& choose(const HaplyFinding& finding, const std::string& id) {
    const std::string place = fmt::format("the {} at {}", service_of(finding), finding.url);
    if (finding.devices.empty())
        throw DeviceAbsent("{} lists no Inverse3: plug it in and switch it on (Haply Hub shows it)", place);
    std::vector<std::string> ids;
    for (const HaplyDevice& device : finding.devices) {
        if (device.id == id || (id.empty() && finding.devices.size() == 1))
            return device;
        ids.push_back(device.id);
    }
    if (!id.empty())
        throw DeviceAbsent("{} lists no device {}; it lists {}", place, id, fmt::join(ids, ", "));
    throw UsageError("{} lists several devices: {}; choose one: --device 'haply:{}?device={}'", place,
                     fmt::join(ids, ", "), finding.url, ids.front());
}

DeviceFacts facts_of(const HaplyFinding& finding, const HaplyDevice& device) {
    DeviceFacts facts;
    std::string type = device.type.empty() ? "inverse3" : device.type;
    if (type == "inverse3")
        facts.max_force = kInverse3Force;
    facts.silence = kHaplySilence;
    facts.buttons = finding.has_grip ? 3 : 0;
    facts.low = glm::dvec3(-kReach);
    facts.high = glm::dvec3(kReach);
    type.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(type.front())));
    facts.name = fmt::format("{} {}", type, device.id);
    facts.software = service_of(finding);
    if (!device.remark.empty())
        facts.remark = fmt::format("{}: {}", facts.name, device.remark);
    return facts;
}

} // namespace

std::unique_ptr<BackEnd> open_haply(const HaplyOptions& options) {
    const HaplyFinding finding = look_for_haply(options.url, options.wait);
    if (!finding.problem.empty())
        throw DeviceAbsent("no Inverse Service at {}: {}. {}", finding.url, finding.problem, kHowToGet);
    const HaplyDevice& device = choose(finding, options.device_id);
    if (!parse_basis(device.basis))
        throw DeviceAbsent("the {} at {} uses the basis '{}' for device {}, which is not a permutation of "
                           "X, Y and Z: set another one in Haply Hub",
                           service_of(finding), finding.url, device.basis, device.id);
    HaplyOptions chosen = options;
    chosen.device_id = device.id;
    if (chosen.dialect == HaplyOptions::Dialect::by_version)
        chosen.dialect = dialect_of(finding.version);
    return std::make_unique<HaplyBackEnd>(facts_of(finding, device), std::move(chosen));
}

} // namespace forceshade::device
