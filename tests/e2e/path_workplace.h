// A folder with scenes that have paths, and the tables that are written of them.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "tests/e2e/workplace.h"

namespace forceshade::testing {

/// The rows of a CSV text by the names of its columns.
inline std::vector<std::map<std::string, std::string>> table_in(const std::string& text) {
    std::vector<std::string> names;
    std::vector<std::map<std::string, std::string>> rows;
    for (const std::string& line : lines_of(text)) {
        const std::vector<std::string> cells = cells_of(line);
        if (names.empty()) {
            names = cells;
            continue;
        }
        EXPECT_EQ(cells.size(), names.size()) << line;
        rows.emplace_back();
        for (std::size_t i = 0; i < std::min(cells.size(), names.size()); ++i)
            rows.back()[names[i]] = cells[i];
    }
    return rows;
}

class Paths : public Workplace {
protected:
    Paths() {
        write("open.toml",
              scene("count = 20\nsteps = 100\nseed = 7\nspeed = { mean = \"100 mm/s\", sd = \"20 mm/s\" }\n"));
        write("closed.toml", scene("count = 6\nsteps = 300\npress = \"1 N\"\n"));
    }
    static std::string scene(const std::string& paths) {
        return "[surface]\nfacets = 3\n[force]\nshading = \"reference\"\n[paths]\n" + paths;
    }
    static std::vector<std::string> explore(const std::string& scene, const std::string& out,
                                            const std::vector<std::string>& further = {}) {
        return with({"explore", scene, "--out", out, "--engine", "cpu"}, further);
    }
};

} // namespace forceshade::testing
