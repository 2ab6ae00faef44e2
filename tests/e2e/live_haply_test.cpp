// A live loop over the simulated Inverse Service: in both dialects, and while the service does what it should not.
#include <glm/geometric.hpp>

#include "tests/device/simulated_service.h"
#include "tests/e2e/live_workplace.h"

namespace forceshade::testing {
namespace {

using device::test::Fault;
using device::test::Received;
using device::test::ServiceScript;
using device::test::SimulatedService;

// A probe that swings through the plane of the scene, up to 2 mm deep, twice a second.
ServiceScript through_the_plane() {
    ServiceScript script;
    script.center = {0, 0, 0};
    script.amplitude = {0.01, 0.01, 0.002};
    script.frequency = 2;
    return script;
}

class LiveHaply : public Live {
protected:
    Launch felt(const std::string& url, const std::string& name, const std::vector<std::string>& further = {}) const {
        return launch(with(live("plane.toml", {"--device", "haply:" + url, "--ramp", "50 ms", "--log", name + ".csv",
                                               "--watchdog", "400 ms"}),
                           further));
    }
    static std::size_t pushes(const SimulatedService& service) {
        return static_cast<std::size_t>(
            std::ranges::count_if(service.received(), [](const Received& one) { return glm::length(one.force) > 0; }));
    }
    // Within the clamp all the time, and nothing at the end.
    static void expect_harmless(const SimulatedService& service, double most) {
        const std::vector<Received> all = service.received();
        ASSERT_FALSE(all.empty());
        for (const Received& one : all) {
            ASSERT_LE(glm::length(one.force), most * (1 + 1e-6));
            ASSERT_TRUE(one.understood);
        }
        EXPECT_EQ(all.back().force, glm::dvec3(0)) << "it is left without force";
    }
};

TEST_F(LiveHaply, FeelsTheSceneInBothDialects) {
    for (const std::string dialect : {"vector", "values"}) {
        SCOPED_TRACE(dialect);
        ServiceScript script = through_the_plane();
        script.speaks_vector = dialect == "vector";
        script.version = script.speaks_vector ? "3.5.0" : "3.1.1";
        const SimulatedService service(script);
        const Outcome outcome =
            run(felt(service.url(), dialect, {"--duration", "1 s", "--max-force", "1 N", "--quiet"}));
        EXPECT_EQ(outcome.code, 0) << outcome.error;
        expect_harmless(service, 1);
        EXPECT_GT(pushes(service), 100u);
        expect_success(replayed("plane.toml", dialect + ".csv", "out.csv", "cpu", "f64"));
        EXPECT_TRUE(felt_in(text(dialect + ".csv")) == text("out.csv"));
        EXPECT_EQ(rows(dialect + ".csv").size(), read_json(dialect + ".live.json")["samples"]);
    }
}

TEST_F(LiveHaply, ThatIsNotThereIsRefused) {
    const std::string url = SimulatedService({}).url(); // nobody else has this port now
    expect_failure(3, felt(url, "log", {"--duration", "1 s"}),
                   {"no Inverse Service at ws://127.0.0.1:", "--device haply:ws://HOST:PORT"});
    expect_failure(2, live("plane.toml", {"--device", "haply:http://there"}), {"http://there", "ws://localhost:10001"});
    EXPECT_FALSE(std::filesystem::exists(path("log.csv")));
}

TEST_F(LiveHaply, ThatDoesNotComeBackIsGivenUp) {
    const std::map<std::string, std::function<void(SimulatedService&)>> faults{
        {"away", [](SimulatedService& service) { service.go_away(); }},
        {"mute", [](SimulatedService& service) { service.set(Fault::never_answers); }},
        {"no_position", [](SimulatedService& service) { service.set(Fault::null); }}};
    for (const auto& [name, fail] : faults) {
        SCOPED_TRACE(name);
        SimulatedService service(through_the_plane());
        Process process(felt(service.url(), name, {"--patience", "0.5 s"}));
        await(process, [&] { return pushes(service) > 0; });
        fail(service);
        const Outcome outcome = process.wait();
        EXPECT_EQ(outcome.code, 3) << outcome.error;
        EXPECT_TRUE(says(outcome.error, "is gone"));
        EXPECT_TRUE(name == "away" || service.received().back().force == glm::dvec3(0));
        const Rows log = rows(name + ".csv");
        EXPECT_EQ(size_in(log.back(), "cx", "cy", "cz"), 0);
        EXPECT_EQ(read_json(name + ".live.json")["samples"], log.size());
    }
}

TEST_F(LiveHaply, IsLeftWithoutForceBySignals) {
    for (const int signal : {SIGINT, SIGTERM, SIGQUIT, SIGABRT, SIGSEGV}) {
        SCOPED_TRACE(signal);
        const SimulatedService service(through_the_plane());
        Process process(felt(service.url(), std::to_string(signal)));
        await(process, [&] {
            const std::vector<Received> all = service.received();
            return !all.empty() && glm::length(all.back().force) > 0.5;
        });
        process.send(signal);
        EXPECT_EQ(process.wait().code, signal == SIGINT || signal == SIGTERM ? 130 : 128 + signal);
        std::this_thread::sleep_for(std::chrono::milliseconds(50)); // what is in the socket is read
        expect_harmless(service, 4);
    }
}

} // namespace
} // namespace forceshade::testing
