// A live loop over the simulated Inverse Service: in both dialects, and while the service does what it should not.
#include "tests/e2e/live_workplace.h"

namespace forceshade::testing {
namespace {

/// The service as a process of its own, until finish().
class Service {
public:
    Service(const Launch& base, const std::string& name, std::vector<std::string> further)
        : forces_(base.folder / (name + ".forces.csv")), port_file_(base.folder / (name + ".port")) {
        Launch launch = base;
        launch.program = HAPLY_SERVICE;
        // Through the plane of the scene, up to 2 mm deep.
        launch.arguments = {"--amplitude", "0.01", "0.01", "0.002", "--frequency", "2", "--forces", forces_.string()};
        if (std::ranges::find(further, "--center") == further.end())
            further.insert(further.begin(), {"--center", "0", "0", "0"});
        launch.arguments.insert(launch.arguments.end(), further.begin(), further.end());
        launch.out = port_file_;
        process_.emplace(launch);
        for (int i = 0; i < 5000 && port_.empty() && process_->running(); ++i) {
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
            const std::string said = read_text(port_file_);
            if (said.starts_with("port ") && said.ends_with('\n'))
                port_ = said.substr(5, said.size() - 6);
        }
        EXPECT_FALSE(port_.empty()) << "the service did not begin";
    }

    std::string device() const { return "haply:ws://127.0.0.1:" + port_; }

    /// Ends it; the forces that it received.
    Rows finish() {
        process_->send(SIGINT);
        EXPECT_EQ(process_->wait().code, 0);
        return table_in(read_text(forces_));
    }

private:
    std::filesystem::path forces_, port_file_;
    std::string port_;
    std::optional<Process> process_;
};

double force_in(const std::map<std::string, std::string>& row) {
    return size_in(row, "force_x_N", "force_y_N", "force_z_N");
}

class LiveHaply : public Live {
protected:
    Service service(const std::string& name, std::vector<std::string> further = {}) const {
        return {launch({}), name, std::move(further)};
    }
    Launch felt(const Service& service, const std::string& name, std::vector<std::string> further) const {
        std::vector<std::string> all = live("plane.toml", {"--device", service.device(), "--ramp", "50 ms", "--log",
                                                           name + ".csv", "--watchdog", "400 ms"});
        all.insert(all.end(), further.begin(), further.end());
        return launch(std::move(all));
    }
    static std::size_t pushes(const Rows& forces) {
        std::size_t count = 0;
        for (const auto& row : forces)
            count += force_in(row) > 0;
        return count;
    }
    // Within the clamp all the time, and nothing at the end.
    static void expect_harmless(const Rows& forces, double most) {
        ASSERT_FALSE(forces.empty());
        for (const auto& row : forces) {
            ASSERT_LE(force_in(row), most * (1 + 1e-6));
            ASSERT_EQ(row.at("understood"), "1");
        }
        EXPECT_EQ(force_in(forces.back()), 0) << "it is left without force";
    }
};

TEST_F(LiveHaply, FeelsTheSceneInBothDialects) {
    for (const char* const dialect : {"vector", "values"}) {
        SCOPED_TRACE(dialect);
        Service there = service(dialect, {"--dialect", dialect});
        const Outcome outcome = run(felt(there, dialect, {"--duration", "1 s", "--max-force", "1 N", "--quiet"}));
        EXPECT_EQ(outcome.code, 0) << outcome.error;
        const Rows forces = there.finish();
        expect_harmless(forces, 1);
        EXPECT_GT(pushes(forces), 100u);
        const std::string log = std::string(dialect) + ".csv";
        expect_success(replayed("plane.toml", log, "out.csv", "cpu", "f64"));
        EXPECT_TRUE(felt_in(text(log)) == text("out.csv"));
        EXPECT_EQ(rows(log).size(), nlohmann::json(read_json(std::string(dialect) + ".live.json"))["samples"]);
    }
}

TEST_F(LiveHaply, ThatIsNotThereIsRefused) {
    Service there = service("gone");
    const Launch launch = felt(there, "log", {"--duration", "1 s"});
    there.finish(); // nobody else has this port now
    expect_failure(3, launch, {"no Inverse Service at ws://127.0.0.1:", "--device haply:ws://HOST:PORT"});
    expect_failure(2, live("plane.toml", {"--device", "haply:http://there"}), {"http://there", "ws://localhost:10001"});
    EXPECT_FALSE(std::filesystem::exists(path("log.csv")));
}

TEST_F(LiveHaply, ThatDoesNotComeBackIsGivenUp) {
    const std::vector<std::string> faults{"away", "never_answers", "nan"};
    std::vector<std::unique_ptr<Service>> services;
    std::vector<std::unique_ptr<Process>> loops;
    for (const std::string& fault : faults) {
        const std::vector<std::string> plan = fault == "away"
                                                  ? std::vector<std::string>{"--away-after", "1"}
                                                  : std::vector<std::string>{"--fault", fault, "--fault-after", "1"};
        services.push_back(std::make_unique<Service>(launch({}), fault, plan));
        loops.push_back(std::make_unique<Process>(felt(*services.back(), fault, {"--patience", "0.5 s"})));
    }
    for (std::size_t i = 0; i < faults.size(); ++i) {
        SCOPED_TRACE(faults[i]);
        const Outcome outcome = loops[i]->wait();
        EXPECT_EQ(outcome.code, 3) << outcome.error;
        EXPECT_NE(outcome.error.find("is gone"), std::string::npos) << outcome.error;
        const Rows forces = services[i]->finish();
        EXPECT_TRUE(faults[i] == "away" || force_in(forces.back()) == 0);
        const Rows log = rows(faults[i] + ".csv");
        EXPECT_EQ(size_in(log.back(), "cx", "cy", "cz"), 0);
        EXPECT_EQ(read_json(faults[i] + ".live.json")["samples"], log.size());
    }
}

TEST_F(LiveHaply, IsLeftWithoutForceBySignals) {
    for (const int signal : {SIGINT, SIGTERM, SIGQUIT, SIGABRT, SIGSEGV}) {
        SCOPED_TRACE(signal);
        const std::string name = std::to_string(signal);
        Service there = service(name);
        Process process(felt(there, name, {}));
        await(process, [&] {
            const std::string all = text(name + ".csv");
            const Rows log = table_in(all.substr(0, all.rfind('\n') + 1));
            return !log.empty() && size_in(log.back(), "cx", "cy", "cz") > 0.5;
        });
        process.send(signal);
        EXPECT_EQ(process.wait().code, signal == SIGINT || signal == SIGTERM ? 130 : 128 + signal);
        std::this_thread::sleep_for(std::chrono::milliseconds(50)); // what is in the socket is read
        expect_harmless(there.finish(), 4);
    }
}

} // namespace
} // namespace forceshade::testing
