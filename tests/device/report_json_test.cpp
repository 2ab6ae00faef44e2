// The end report for programs: every key, every count, null for what is no number.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "device/report/report.h"
#include "host/program.h"
#include "tests/device/report_cases.h"

namespace forceshade::device::test {
namespace {

using Json = nlohmann::ordered_json;

TEST(ReportJson, can_be_read_again_whatever_it_is_told) {
    for (const auto& [file, outcome] : cases()) {
        const Json json = report_json(outcome);
        Json again;
        ASSERT_NO_THROW(again = Json::parse(json.dump(2))) << file;
        EXPECT_EQ(again, json) << file;
        EXPECT_EQ(json["version"], version());
        for (const char* times : {"compute", "read", "write", "late", "jitter"}) {
            std::uint64_t counted = 0, end = 0;
            for (const Json& bin : json[times]["histogram"]) {
                EXPECT_GE(bin["from_ns"].get<std::uint64_t>(), end);
                end = bin["to_ns"].get<std::uint64_t>();
                EXPECT_GT(bin["count"].get<std::uint64_t>(), 0u);
                counted += bin["count"].get<std::uint64_t>();
            }
            EXPECT_EQ(json[times]["count"], counted) << file << " " << times;
        }
    }
}

TEST(ReportJson, holds_what_the_run_came_to) {
    const LiveOutcome outcome = usual(1000);
    const Json json = report_json(outcome);
    EXPECT_EQ(json["scene"], "bump.toml");
    EXPECT_EQ(json["precision"], "f64");
    EXPECT_EQ(json["device"]["asked_for"], "sim");
    EXPECT_EQ(json["device"]["max_force_N"], 3.3);
    EXPECT_EQ(json["device"]["simulated"], true);
    EXPECT_EQ(json["rate_Hz"], 1000);
    EXPECT_EQ(json["real_time"], true);
    EXPECT_EQ(json["ended"], "after 60 s");
    EXPECT_EQ(json["elapsed_s"], 60);
    EXPECT_EQ(json["samples"], 60000);
    EXPECT_EQ(json["waiting"], 12);
    EXPECT_EQ(json["in_contact"], 41230);
    EXPECT_EQ(json["paths"], 1);
    EXPECT_EQ(json["largest_force_N"], 3.214);
    EXPECT_EQ(json["largest_commanded_N"], 3);
    EXPECT_EQ(json["largest_depth_m"], 2.14e-3);
    EXPECT_EQ(json["largest_speed_m_per_s"], 0.251);
    EXPECT_EQ(json["energy_J"], -1.25e-3);
    EXPECT_EQ(json["largest_energy_J"], 3.4e-4);
    EXPECT_EQ(json["damped_J"], 0);
    EXPECT_EQ(json["log"], (Json{{"file", "live.csv"}, {"samples", 60000}, {"lost", 0}}));
    EXPECT_EQ(json["sent"], (Json{{"to", nullptr}, {"samples", 0}, {"dropped", 0}}));
    EXPECT_EQ(report_json(talkative())["sent"],
              (Json{{"to", "udp:127.0.0.1:5005"}, {"samples", 59900}, {"dropped", 100}}));
    EXPECT_EQ(json["limits"]["max_slew"], "1 N/ms");
    EXPECT_EQ(json["permissions"][0]["what"], "SCHED_FIFO");
    EXPECT_EQ(json["permissions"][0]["granted"], false);
    EXPECT_EQ(json["permissions"][1]["detail"], "all pages");
    EXPECT_EQ(json["happened"].size(), kSampleFlagNames.size());
    EXPECT_EQ(json["happened"]["clamped"], 12);
    EXPECT_EQ(json["happened"]["overrun"], 3);
    EXPECT_EQ(json["happened"]["own_overrun"], 0);
    EXPECT_EQ(json["compute"]["p50_ns"], outcome.counts.computing.quantile(0.5));
    EXPECT_EQ(json["compute"]["p99_ns"], outcome.counts.computing.quantile(0.99));
    EXPECT_EQ(json["compute"]["p99_9_ns"], outcome.counts.computing.quantile(0.999));
    EXPECT_EQ(json["late"]["largest_ns"], outcome.counts.late.largest());
    EXPECT_EQ(json["jitter"]["mean_ns"], outcome.counts.jitter.mean());
    EXPECT_EQ(json["read"]["p50_ns"], outcome.counts.reading.quantile(0.5));
    EXPECT_EQ(json["write"]["p50_ns"], outcome.counts.writing.quantile(0.5));
}

TEST(ReportJson, what_is_no_number_is_null) {
    const Json json = report_json(beyond());
    EXPECT_TRUE(json["largest_force_N"].is_null());
    EXPECT_TRUE(json["energy_J"].is_null());
    EXPECT_TRUE(json["device"]["max_force_N"].is_null());
    EXPECT_TRUE(json["device"]["workspace_low_m"][2].is_null());
    const Json none = report_json(no_sample());
    EXPECT_TRUE(none["compute"]["p50_ns"].is_null());
    EXPECT_TRUE(none["compute"]["largest_ns"].is_null());
    EXPECT_TRUE(none["log"]["file"].is_null());
    EXPECT_EQ(none["compute"]["histogram"], Json::array());
}

} // namespace
} // namespace forceshade::device::test
