// What the commands of the program have in common: shared flags, the engine they choose, where text goes.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/engine/engine.h"
#include "host/scene/study.h"

namespace CLI {
class App;
}

namespace forceshade {

/// Flags that every command takes.
struct CommonOptions {
    std::string gpu;            /* name, UUID or index; empty: the software device */
    std::string engine = "gpu"; /* "gpu" or "cpu" */
    std::string precision;      /* "f32", "f64" or empty: as the scene says */
    bool json = false;
    bool quiet = false;
    bool validation_layers = false;
};

/// A command, ready to run: its exit code, or an exception.
using Command = std::function<int()>;

/// Each adds its subcommand to the program; `chosen` becomes the command that the user named.
void add_sweep_command(CLI::App& program, const CommonOptions& common, Command& chosen);
void add_field_command(CLI::App& program, const CommonOptions& common, Command& chosen);
void add_explore_command(CLI::App& program, const CommonOptions& common, Command& chosen);
void add_mesh_command(CLI::App& program, const CommonOptions& common, Command& chosen);
void add_study_command(CLI::App& program, const CommonOptions& common, Command& chosen);
void add_report_command(CLI::App& program, const CommonOptions& common, Command& chosen);
void add_live_command(CLI::App& program, const CommonOptions& common, Command& chosen);
void add_validate_command(CLI::App& program, const CommonOptions& common, Command& chosen);
void add_gpus_command(CLI::App& program, const CommonOptions& common, Command& chosen);
void add_devices_command(CLI::App& program, const CommonOptions& common, Command& chosen);
void add_doctor_command(CLI::App& program, const CommonOptions& common, Command& chosen);
void add_schema_command(CLI::App& program, const CommonOptions& common, Command& chosen);

/// What the flags say about the engine. `needs_f64`: some case runs in double precision.
EngineOptions engine_options(const CommonOptions& common, bool needs_f64);

/// Flags that replace keys of the scene.
std::vector<Override> overrides(const CommonOptions& common);

/// The study in a file, or the paper's if `path` is empty; its warnings go to stderr unless quiet.
Study load_study(const std::string& path, const CommonOptions& common);
void print_warnings(const std::vector<std::string>& warnings, const CommonOptions& common);

/// True if some case runs in double precision.
bool any_f64(const Study& study);

/// Data for stdout. \throws IoError if it cannot be written.
void print_data(const std::string& text);

} // namespace forceshade
