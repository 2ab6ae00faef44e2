// What the commands of the program have in common: shared flags, the engine they choose, where text goes.
#pragma once

#include <string>
#include <vector>

#include "host/cli/options.h"
#include "host/engine/engine.h"
#include "host/scene/study.h"

namespace forceshade {

/// Each adds its subcommand to the program.
void add_sweep_command(CommandLine& program);
void add_field_command(CommandLine& program);
void add_explore_command(CommandLine& program);
void add_mesh_command(CommandLine& program);
void add_study_command(CommandLine& program);
void add_report_command(CommandLine& program);
void add_live_command(CommandLine& program);
void add_validate_command(CommandLine& program);
void add_gpus_command(CommandLine& program);
void add_devices_command(CommandLine& program);
void add_doctor_command(CommandLine& program);
void add_schema_command(CommandLine& program);

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
