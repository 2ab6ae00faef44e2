#include <CLI/CLI.hpp>

#include "host/cli/command.h"
#include "host/error.h"
#include "host/scene/schema.h"

namespace forceshade {

void add_schema_command(CLI::App& program, const CommonOptions& common, Command& chosen) {
    const auto paper = std::make_shared<bool>(false);
    CLI::App* command =
        program.add_subcommand("schema", "Print every key of a scene or study, its unit, default and meaning");
    command->add_flag("--default-study", *paper, "print the built-in study of the paper instead, to start from");
    command->callback([=, &common, &chosen] {
        chosen = [=, &common] {
            if (*paper && common.json)
                throw UsageError("--default-study prints TOML: leave out --json");
            print_data(*paper ? std::string(default_study_toml()) : common.json ? schema_json() : schema_text());
            return 0;
        };
    });
}

} // namespace forceshade
