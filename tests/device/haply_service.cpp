// The simulated Inverse Service as a program: prints `port N`, runs until SIGINT, SIGTERM or --seconds, then writes
// every force that it received, as CSV.
#include <csignal>
#include <cstdio>
#include <ctime>
#include <thread>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "tests/device/simulated_service.h"

namespace {

using forceshade::device::test::Fault;
using forceshade::device::test::Received;
using forceshade::device::test::ServiceScript;
using forceshade::device::test::SimulatedService;
using Clock = std::chrono::steady_clock;

struct Plan {
    std::string dialect = "vector", fault = "none", forces;
    double seconds = 60, fault_after = 0, fault_for = 1e9, away_after = 1e9, away_for = 1e9;
    int delay = 250;
    std::vector<double> center{0, -0.1, 0.15}, amplitude{0.01, 0.02, 0.03};
};

void write_forces(const std::string& path, const std::vector<Received>& all, Clock::time_point start) {
    std::FILE* const file = std::fopen(path.c_str(), "w");
    if (file == nullptr)
        throw std::runtime_error("cannot write " + path);
    fmt::print(file, "time_s,connection,device,understood,force_x_N,force_y_N,force_z_N\n");
    for (const Received& each : all)
        fmt::print(file, "{:.6f},{},{},{},{},{},{}\n", std::chrono::duration<double>(each.time - start).count(),
                   each.connection, each.device_id, each.understood ? 1 : 0, each.force.x, each.force.y, each.force.z);
    if (std::fclose(file) != 0)
        throw std::runtime_error("cannot write " + path);
}

/// Until a signal or the end of the plan, doing what is due at its time.
void run(SimulatedService& service, const Plan& plan, Clock::time_point start, const sigset_t& signals) {
    const Fault fault = forceshade::device::test::fault_named(plan.fault);
    bool faulty = false, away = false;
    for (double time = 0; time < plan.seconds;) {
        const bool now_faulty = time >= plan.fault_after && time < plan.fault_after + plan.fault_for;
        if (now_faulty != faulty)
            service.set((faulty = now_faulty) ? fault : Fault::none);
        const bool now_away = time >= plan.away_after && time < plan.away_after + plan.away_for;
        if (now_away != away)
            (away = now_away) ? service.go_away() : service.come_back();
        const timespec nap{0, 10'000'000};
        if (sigtimedwait(&signals, nullptr, &nap) > 0)
            return;
        time = std::chrono::duration<double>(Clock::now() - start).count();
    }
}

} // namespace

int main(int argc, char** argv) try {
    CLI::App app{"An Inverse Service that is none: a probe that swings, in either dialect, with faults on demand."};
    ServiceScript script;
    Plan plan;
    app.add_option("--port", script.port, "0: any that is free");
    app.add_option("--dialect", plan.dialect, "how it reads forces")->check(CLI::IsMember({"vector", "values"}));
    app.add_option("--service-version", script.version, "what GET /version tells; empty: nothing");
    app.add_option("--basis", script.basis, "axes, XYZ: x right, y away, z up");
    app.add_option("--device", script.devices, "ids; several are several devices");
    app.add_option("--center", plan.center, "m: where the probe swings about")->expected(3);
    app.add_option("--amplitude", plan.amplitude, "m")->expected(3);
    app.add_option("--frequency", script.frequency, "Hz");
    app.add_option("--fault", plan.fault, "by the name it has in simulated_service.h");
    app.add_option("--fault-after", plan.fault_after, "s");
    app.add_option("--fault-for", plan.fault_for, "s");
    app.add_option("--away-after", plan.away_after, "s: closes all connections and listens no more");
    app.add_option("--away-for", plan.away_for, "s");
    app.add_option("--delay", plan.delay, "ms: of the fault `late`");
    app.add_option("--forces", plan.forces, "CSV file for the forces received");
    app.add_option("--seconds", plan.seconds, "at most so long");
    CLI11_PARSE(app, argc, argv);

    script.speaks_vector = plan.dialect == "vector";
    if (app.count("--service-version") == 0 && !script.speaks_vector)
        script.version = "3.1.1";
    script.delay = std::chrono::milliseconds(plan.delay);
    for (int i = 0; i < 3; ++i) {
        script.center[i] = plan.center[static_cast<std::size_t>(i)];
        script.amplitude[i] = plan.amplitude[static_cast<std::size_t>(i)];
    }
    if (plan.fault_after <= 0)
        script.fault = forceshade::device::test::fault_named(plan.fault);
    sigset_t signals;
    sigemptyset(&signals);
    sigaddset(&signals, SIGINT);
    sigaddset(&signals, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &signals, nullptr); // before the service has its thread
    const Clock::time_point start = Clock::now();
    SimulatedService service(script);
    fmt::print("port {}\n", service.port());
    std::fflush(stdout);
    run(service, plan, start, signals);
    if (!plan.forces.empty())
        write_forces(plan.forces, service.received(), start);
    return 0;
} catch (const std::exception& error) {
    fmt::print(stderr, "haply_service: {}\n", error.what());
    return 1;
}
