// A scratch folder in which studies are run, and what they must leave.
#pragma once

#include "tests/e2e/workplace.h"

namespace forceshade::testing {

constexpr double kStudyPatience = 300; // s, on a machine that others load too

/// The cells of a table of study.json, of one column.
std::vector<nlohmann::json> column_of(const nlohmann::json& table, std::size_t column);

class Study : public Workplace {
protected:
    /// Arguments of the quick form.
    static std::vector<std::string> quick(const std::string& name, const std::string& out) {
        return {"study", name, "--quick", "--out", out, "--quiet"};
    }
    Outcome run_study(std::vector<std::string> arguments) const;
    void expect_study(std::vector<std::string> arguments) const;

    /// A study's folder holds all that its study.json speaks of, and that is in order.
    void expect_whole(const std::string& folder, const std::string& study) const;

private:
    void expect_csv_as_json(const std::string& folder, const nlohmann::json& table) const;
};

} // namespace forceshade::testing
