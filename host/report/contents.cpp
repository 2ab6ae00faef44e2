#include "host/report/sections.h"

#include <algorithm>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/error.h"
#include "host/output/files.h"
#include "host/output/json.h"
#include "host/study/study_data.h"

namespace forceshade::report {
namespace {

constexpr std::uint64_t kMostHashed = 64u << 20; /* bytes; of larger files only the size is compared */

// False also without permission to look.
bool is_there(const std::filesystem::path& path) {
    std::error_code ignored;
    return std::filesystem::exists(path, ignored);
}

// A sweep or a study, or the remains of one.
bool has_results(const std::filesystem::path& folder) {
    return is_there(folder / "manifest.json") || is_there(folder / "manifest.d") || is_there(folder / "study.json");
}

// The names in a folder for which wanted(entry, name) holds, in order; hidden ones are never wanted.
template <typename Wanted>
std::vector<std::string> names_in(const std::filesystem::path& folder, std::error_code& error, const Wanted& wanted) {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
        const std::string name = entry.path().filename().string();
        if (name.front() != '.' && wanted(entry, name))
            names.push_back(name);
    }
    std::ranges::sort(names);
    return names;
}

std::vector<std::string> names_with(const std::filesystem::path& folder, const char* ending) {
    std::error_code ignored;
    return names_in(folder, ignored, [&](const auto&, const std::string& name) { return name.ends_with(ending); });
}

void take_account(Sweep& sweep, const Json& manifest) {
    const auto text = [](const Json& json, const char* key) {
        return json.contains(key) && json[key].is_string() ? json[key].get<std::string>() : std::string();
    };
    const auto number = [](const Json& json, const char* key) {
        return json.contains(key) && json[key].is_number() ? json[key].get<double>() : 0.0;
    };
    sweep.program = text(manifest, "program");
    sweep.cases_of_study = static_cast<std::size_t>(std::clamp(number(manifest, "cases_of_study"), 0.0, 1e15));
    if (!manifest.contains("last_run") || !manifest["last_run"].is_object())
        return;
    const Json& run = manifest["last_run"];
    sweep.device = text(run, "device");
    sweep.driver = text(run, "driver");
    sweep.cpu = text(run, "cpu");
    sweep.cores = static_cast<unsigned>(std::clamp(number(run, "cores"), 0.0, 1e6));
    sweep.seconds = number(run, "wall_s");
}

struct Reading {
    const std::filesystem::path& root;
    Contents contents;

    template <class... Arguments>
    void trouble(const std::string& file, fmt::format_string<Arguments...> what, Arguments&&... arguments) {
        contents.troubles.push_back(file + ": " + fmt::format(what, std::forward<Arguments>(arguments)...));
    }

    void check_file(const std::string& folder, const FileRecord& file) {
        const std::string name = below(folder, file.name);
        if (!is_plain_name(file.name)) {
            trouble(name, "it lies outside of the folder and was not looked at");
            return;
        }
        std::error_code error;
        const std::uint64_t bytes = std::filesystem::file_size(root / name, error);
        if (error)
            trouble(name, "it is missing");
        else if (bytes != file.bytes)
            trouble(name, "it has {} bytes where {} were written", bytes, file.bytes);
        else if (bytes <= kMostHashed && !file_is_intact(root / name, file.sha256))
            trouble(name, "its contents are not what was written");
    }

    // The page draws figures out of tables.
    void check_figure(const std::string& folder, const StudyPart& part, const study::Figure& figure) {
        try {
            const study::Table& table = part.data.table(figure.table);
            for (const std::string* column :
                 {&figure.x.column, &figure.y.column, &figure.series, &figure.shape, &figure.value})
                if (!column->empty())
                    table.index(*column);
            for (const study::Curve& curve : figure.curves)
                part.data.table(curve.table).index(curve.x);
        } catch (const Error& error) {
            trouble(below(folder, "study.json"), "the figure {} cannot be drawn: {}", figure.name, error.what());
        }
    }

    // Volumes that neither a manifest nor a study.json names.
    void check_loose(const std::string& folder) {
        std::set<std::string> known;
        std::string account;
        const auto know = [&](const std::vector<FileRecord>& files) {
            for (const FileRecord& file : files)
                known.insert(file.name);
        };
        for (const StudyPart& part : contents.studies)
            if (part.folder == folder) {
                account = "study.json";
                know(part.data.volumes);
            }
        for (const Sweep& sweep : contents.sweeps)
            if (sweep.folder == folder) {
                account = "the manifest";
                for (const CaseRecord& record : sweep.cases)
                    know(record.files);
            }
        if (!account.empty())
            for (const std::string& name : names_with(root / folder, ".exr"))
                if (!known.contains(name))
                    trouble(below(folder, name), "not listed in {}, skipped", account);
    }

    void take_case(Sweep& sweep, const std::string& where, const Json& json) {
        if (std::optional<CaseRecord> record = record_of(json)) {
            for (const FileRecord& file : record->files)
                check_file(sweep.folder, file);
            if (const std::string wrong = error_text(*record); !wrong.empty())
                contents.troubles.push_back(wrong);
            sweep.cases.push_back(std::move(*record));
        } else {
            trouble(where, "this case cannot be understood, it may be of another version of the program");
        }
    }

    void read_manifest(const std::string& folder) {
        const std::string name = below(folder, "manifest.json");
        const std::vector<std::string> record_names = names_with(root / folder / "manifest.d", ".json");
        if (record_names.empty() && !is_there(root / name))
            return;
        Sweep sweep;
        sweep.folder = folder;
        Json manifest;
        std::string wrong = "not a sweep manifest";
        try {
            manifest = read_json(root / name);
            if (manifest.is_discarded())
                wrong = "it is damaged";
        } catch (const Error& error) {
            wrong = error.what();
        }
        if (manifest.is_object() && manifest.contains("cases") && manifest["cases"].is_array()) {
            const Json format = manifest.value("format", Json());
            if (format != kManifestFormat)
                trouble(name,
                        "its format is {}, this program writes {}; what can be understood of it is shown, a sweep "
                        "with this program brings it up to date",
                        format.is_null() ? "an older one" : format.dump(), kManifestFormat);
            take_account(sweep, manifest);
            std::size_t number = 0;
            for (const Json& one : manifest["cases"])
                take_case(sweep, fmt::format("{}, case {}", name, ++number), one);
        } else {
            trouble(name, "{}{}", wrong, record_names.empty() ? "" : "; the cases are taken from manifest.d");
            for (const std::string& one : record_names) {
                const std::string record = below(folder, "manifest.d/" + one);
                try {
                    take_case(sweep, record, read_json(root / record));
                } catch (const Error& error) {
                    trouble(record, "{}", error.what());
                }
            }
        }
        sweep.cases_of_study = std::max(sweep.cases_of_study, sweep.cases.size());
        if (sweep.cases.empty())
            trouble(name, "it holds no case");
        sweep.findings = sweep_findings(sweep);
        contents.sweeps.push_back(std::move(sweep));
    }

    void read_study(const std::string& folder) {
        const std::string name = below(folder, "study.json");
        if (!is_there(root / name))
            return;
        StudyPart part;
        part.folder = folder;
        try {
            part.data = study::read_data(root / folder);
        } catch (const Error& error) {
            trouble(name, "{}", error.what());
            return;
        }
        for (const study::Figure& figure : part.data.figures)
            check_figure(folder, part, figure);
        for (const std::vector<FileRecord>* files : {&part.data.files, &part.data.volumes})
            for (const FileRecord& file : *files)
                check_file(folder, file);
        contents.studies.push_back(std::move(part));
    }
};

std::vector<std::string> folders_below(const std::filesystem::path& root, std::error_code& error) {
    return names_in(root, error, [](const auto& entry, const std::string& name) {
        std::error_code vanished;
        return entry.is_directory(vanished) && !name.ends_with(".d");
    });
}

// Those that may hold results, the report's own first.
std::vector<std::string> folders_of(const std::filesystem::path& root) {
    std::vector<std::string> folders{""};
    std::error_code error;
    const std::vector<std::string> names = folders_below(root, error);
    if (error)
        throw IoError("cannot read the folder {}: {}", root.string(), error.message());
    for (const std::string& name : names) {
        folders.push_back(name);
        if (has_results(root / name))
            continue;
        for (const std::string& deeper : folders_below(root / name, error))
            if (has_results(root / name / deeper))
                folders.push_back(below(name, deeper));
    }
    return folders;
}

} // namespace

std::string below(const std::string& folder, const std::string& name) {
    return folder.empty() ? name : folder + "/" + name;
}

Contents read_contents(const std::filesystem::path& folder) {
    Reading reading{folder, {}};
    for (const std::string& one : folders_of(folder)) {
        reading.read_manifest(one);
        reading.read_study(one);
        reading.check_loose(one);
    }
    // In the order of the command line's help, foreign ones last.
    const std::vector<std::string> order{"error-time", "stability", "energy", "omission"};
    std::ranges::stable_sort(reading.contents.studies, {}, [&](const StudyPart& part) {
        return std::ranges::find(order, part.data.study) - order.begin();
    });
    return std::move(reading.contents);
}

} // namespace forceshade::report
