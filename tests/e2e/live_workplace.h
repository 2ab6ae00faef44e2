// A folder with scenes that a live loop lets somebody feel, and what it leaves of it.
#pragma once

#include <cmath>
#include <csignal>
#include <fstream>
#include <sstream>
#include <thread>

#include <fmt/format.h>

#include "tests/e2e/path_workplace.h"
#include "tests/places.h"

namespace forceshade::testing {

using Rows = std::vector<std::map<std::string, std::string>>;

/// A force that the stub of a device was told, in the vendor's axes.
struct Told {
    double time = 0; /* s, of the steady clock */
    double x = 0, y = 0, z = 0;

    double size() const { return std::sqrt(x * x + y * y + z * z); }
};

inline double number_in(const std::map<std::string, std::string>& row, const char* column) {
    return std::stod(row.at(column));
}

inline double size_in(const std::map<std::string, std::string>& row, const char* x, const char* y, const char* z) {
    return std::sqrt(number_in(row, x) * number_in(row, x) + number_in(row, y) * number_in(row, y) +
                     number_in(row, z) * number_in(row, z));
}

/// Whether a row tells that something happened.
inline bool happened_in(const std::map<std::string, std::string>& row, const std::string& name) {
    return ("+" + row.at("happened") + "+").find("+" + name + "+") != std::string::npos;
}

/// The columns from path to facet of a log: what explore writes.
inline std::string felt_in(const std::string& log) {
    constexpr int kFelt = 13;
    std::string felt;
    for (const std::string& line : lines_of(log)) {
        std::size_t end = 0;
        for (int i = 0; i < kFelt && end != std::string::npos; ++i)
            end = line.find(',', end == 0 ? 0 : end + 1);
        felt += line.substr(0, end) + "\n";
    }
    return felt;
}

class Live : public Workplace {
protected:
    Live() {
        write("plane.toml", "[force]\nstiffness = \"1 N/mm\"\n");
        write("bump.toml", "[surface]\nfacets = 3\n[force]\nshading = \"reference\"\n");
        write("map.toml", "[surface]\nkind = \"height_map\"\nfunction = \"gaussian\"\nheight = \"3 mm\"\nradius = \"8 "
                          "mm\"\n[force]\nshading = \"height_map\"\n[texture]\nstiffness = \"0.2 N/mm\"\nfunction = "
                          "\"sine\"\nwidth = \"2 mm\"\nheight = \"0.1 mm\"\n");
        write("mesh.toml", "[surface]\nkind = \"mesh\"\nfile = \"spot.obj\"\ntransform = { scale = 0.05, rotate = "
                           "[\"90 deg\", \"0 deg\", \"0 deg\"] }\n[force]\nshading = \"mean_value\"\n");
        std::filesystem::create_symlink(in_source("tests/data/spot.obj"), path("spot.obj"));
        write("hand.toml", "[surface]\nfacets = 3\n[force]\nshading = \"reference\"\n[paths]\ncount = 1\nsteps = "
                           "2000\nloop = \"closed\"\npress = \"2 N\"\ntremor = { amplitude = \"0.1 mm\" }\n[hand]\n"
                           "coulomb = \"0.05 N\"\nquantisation = \"0.03 mm\"\ndelay_samples = 1\n");
    }

    static std::vector<std::string> live(const std::string& scene, const std::vector<std::string>& further = {}) {
        return with({"live", scene}, further);
    }
    static std::vector<std::string> replayed(const std::string& scene, const std::string& log, const std::string& out,
                                             const std::string& engine, const std::string& precision) {
        return {"explore",     scene,      "--paths", log,           "--out",   out,
                "--open-loop", "--engine", engine,    "--precision", precision, "--quiet"};
    }

    std::string text(const std::string& name) const { return read_text(path(name)); }
    Rows rows(const std::string& name) const { return table_in(text(name)); }

    /// A recording that rests a millimetre deep, with a row each millisecond.
    void write_still(const std::string& name, int rows) const {
        std::string table = "path,t,x,y,z\n";
        for (int i = 0; i < rows; ++i)
            table += fmt::format("0,{},0,0,-0.001\n", 1e-3 * i);
        write(name, table);
    }

    /// Waits for something as long as a process runs; false, and a failure, if it does not come about.
    template <typename Condition> static bool await(Process& process, Condition&& condition, double most = 30) {
        const auto begin = std::chrono::steady_clock::now();
        while (process.running() && std::chrono::steady_clock::now() - begin < std::chrono::duration<double>(most)) {
            if (condition())
                return true;
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
        }
        ADD_FAILURE() << "did not come about: " << process.running();
        return false;
    }
};

/// A device behind the stub of Force Dimension's library, resting a millimetre deep in the plane.
class LiveDevice : public Live {
protected:
    Launch felt(const std::vector<std::string>& further, const std::string& fail = "") const {
        Launch launch = this->launch(
            with(live("plane.toml", {"--device", "dhd", "--ramp", "50 ms", "--watchdog", "400 ms"}), further));
        launch.environment["FORCESHADE_DHD_LIBRARY"] = module_of("device", "dhd_stub");
        launch.environment["STUB_RECORD"] = path("record").string();
        launch.environment["STUB_POSITION"] = "0,0,-0.001";
        launch.environment["STUB_FAIL"] = fail;
        launch.error = path("stderr");
        std::filesystem::remove(path("record"));
        std::filesystem::remove(path("stderr"));
        return launch;
    }

    /// What the device was told so far, whole lines only.
    std::vector<Told> record() const {
        const std::string all = text("record");
        std::istringstream lines(all.substr(0, all.rfind('\n') + 1));
        std::vector<Told> record;
        for (Told told; lines >> told.time >> told.x >> told.y >> told.z;)
            record.push_back(told);
        return record;
    }
    bool is_pushing() const {
        const std::vector<Told> told = record();
        return !told.empty() && told.back().size() > 0.95;
    }
    static double now() {
        return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
    }
    /// How many forces but zero it was told after a time.
    static std::size_t pushes_after(const std::vector<Told>& record, double time) {
        std::size_t count = 0;
        for (const Told& told : record)
            count += told.time > time && told.size() > 0;
        return count;
    }
};

} // namespace forceshade::testing
