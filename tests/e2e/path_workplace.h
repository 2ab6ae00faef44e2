// A folder with scenes that have paths, and the tables that are written of them.
#pragma once

#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "tests/e2e/workplace.h"

namespace forceshade::testing {

/// The rows of a CSV text by the names of its columns.
inline std::vector<std::map<std::string, std::string>> table_in(const std::string& text) {
    const auto cells_of = [](const std::string& line) {
        std::vector<std::string> cells(1);
        for (const char c : line)
            if (c == ',')
                cells.emplace_back();
            else
                cells.back() += c;
        return cells;
    };
    std::istringstream lines(text);
    std::string line;
    std::getline(lines, line);
    const std::vector<std::string> names = cells_of(line);
    std::vector<std::map<std::string, std::string>> rows;
    while (std::getline(lines, line)) {
        const std::vector<std::string> cells = cells_of(line);
        EXPECT_EQ(cells.size(), names.size()) << line;
        for (std::size_t i = 0; i < std::min(cells.size(), names.size()); ++i)
            (i == 0 ? rows.emplace_back() : rows.back())[names[i]] = cells[i];
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
                                            std::vector<std::string> further = {}) {
        std::vector<std::string> all{"explore", scene, "--out", out, "--engine", "cpu"};
        all.insert(all.end(), further.begin(), further.end());
        return all;
    }
    std::vector<std::string> names() const {
        std::vector<std::string> names = folder_.names();
        std::erase_if(names, [](const std::string& name) { return name.ends_with(".toml") || name == "cache"; });
        return names;
    }
};

} // namespace forceshade::testing
