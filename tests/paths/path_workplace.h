// A folder with paths, scenes to take them through, and what was written read back.
#pragma once

#include <charconv>
#include <string>
#include <vector>

#include <glm/vec3.hpp>
#include <gtest/gtest.h>

#include "host/cases/case_pipeline.h"
#include "host/error.h"
#include "tests/io/folder.h"

namespace forceshade::testing {

/// A number as it was written, in the precision that it was written in; it must be the whole of the text.
template <typename T> T number_in(const std::string& text) {
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    EXPECT_TRUE(error == std::errc() && end == text.data() + text.size()) << text;
    return value;
}

class PathWorkplace : public ::testing::Test {
protected:
    std::filesystem::path path(const std::string& name) const { return folder_ / name; }

    std::filesystem::path write(const std::string& name, const std::string& text) const {
        return folder_.write(name, text);
    }
    std::string read(const std::string& name) const { return folder_.read(name); }

    PreparedCase prepare(const std::string& scene, Precision precision = Precision::f64) const {
        const std::vector<Override> replaced{{"run.precision", precision == Precision::f32 ? "f32" : "f64"}};
        return CasePreparation().prepare(parse_scene(scene, "scene", folder_.path(), replaced));
    }

    PathRecord explore(const PreparedCase& prepared, const std::string& paths,
                       const std::string& out = "out.csv") const {
        EngineOptions engine;
        engine.cpu = true;
        PathRunOptions options;
        options.recorded = path(paths);
        options.samples = path(out);
        options.stem = path(out).replace_extension();
        options.threads = 1;
        return run_paths(*make_engine(engine), prepared, options);
    }

    /// The text that a scene makes of a text, path after path.
    std::string felt(const PreparedCase& prepared, const std::string& paths) const {
        write("in.csv", paths);
        explore(prepared, "in.csv");
        return read("out.csv");
    }

    Folder folder_;
};

/// The lines of a text below its header, split at commas.
inline std::vector<std::vector<std::string>> rows_of(const std::string& text) {
    std::vector<std::vector<std::string>> rows;
    for (const std::string& line : lines_of(text))
        rows.push_back(cells_of(line));
    if (!rows.empty())
        rows.erase(rows.begin());
    return rows;
}

/// What a probe felt at a place.
struct Felt {
    glm::dvec3 probe, proxy, force;
    double depth;
    int facet;
};

/// The rows that were written of paths.
inline std::vector<Felt> felt_rows(const std::string& text) {
    std::vector<Felt> all;
    for (const auto& cells : rows_of(text)) {
        const auto vector = [&](std::size_t first) {
            return glm::dvec3(number_in<double>(cells[first]), number_in<double>(cells[first + 1]),
                              number_in<double>(cells[first + 2]));
        };
        all.push_back({vector(2), vector(5), vector(8), number_in<double>(cells[11]), number_in<int>(cells[12])});
    }
    return all;
}

} // namespace forceshade::testing
