#include "host/experiment/record.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <ctime>
#include <fcntl.h>
#include <functional>
#include <set>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/error.h"
#include "host/output/files.h"
#include "host/output/raw_formats.h"
#include "host/output/reading.h"
#include "host/paths/path_reader.h"
#include "host/program.h"

namespace forceshade::experiment {
namespace {

using Json = nlohmann::ordered_json;

template <typename T> bool parsed(std::string_view text, T& value) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size();
}

// A column of the data: what stands in it, and how it is read back. `read` is false for what it cannot be.
struct DataColumn {
    const char* name;
    const char* unit;
    const char* meaning;
    std::function<std::string(const TrialRow&)> text;
    std::function<bool(TrialRow&, std::string_view)> read;
};

template <typename Part> DataColumn column_of(const char* name, const char* unit, const char* meaning, Part part) {
    using T = std::remove_cvref_t<decltype(part(std::declval<TrialRow&>()))>;
    return {name, unit, meaning,
            [part](const TrialRow& row) {
                const T& value = part(const_cast<TrialRow&>(row));
                if constexpr (std::is_same_v<T, std::string>)
                    return value;
                else
                    return fmt::format("{}", value);
            },
            [part](TrialRow& row, std::string_view text) {
                if constexpr (std::is_same_v<T, std::string>) {
                    part(row) = text;
                    return true;
                } else {
                    return parsed(text, part(row));
                }
            }};
}

const std::vector<DataColumn>& data_columns() {
    using R = TrialRow;
    static const std::vector<DataColumn> columns{
        {"row_id", "", "subject, session and sequence",
         [](const R& r) { return fmt::format("{}-{}-{}", r.subject, r.session, r.sequence); },
         [](R&, std::string_view text) { return !text.empty(); }},
        column_of(
            "subject", "", "as given at the start", [](R & r) -> auto& { return r.subject; }),
        column_of(
            "session", "", "of the subject, from 1 on", [](R & r) -> auto& { return r.session; }),
        column_of(
            "sequence", "", "of the trials as they were done, from 1 on", [](R & r) -> auto& { return r.sequence; }),
        column_of(
            "trial", "", "number in the order that was drawn before; one that failed comes again",
            [](R & r) -> auto& { return r.number; }),
        column_of(
            "block", "", "from 1 on; 0: practice", [](R & r) -> auto& { return r.block; }),
        column_of(
            "condition", "", "name of the stimulus", [](R & r) -> auto& { return r.condition; }),
        column_of(
            "answer", "", "name of the answer; empty: none", [](R & r) -> auto& { return r.answer; }),
        {"correct", "", "1: it names the stimulus' nominal shape, 0: it does not; empty: no answer is right",
         [](const R& r) { return std::string(r.correct ? (*r.correct ? "1" : "0") : ""); },
         [](R& r, std::string_view text) {
             if (!text.empty())
                 r.correct = text == "1";
             return text.empty() || text == "1" || text == "0";
         }},
        column_of(
            "status", "", "answered, or why the trial does not count and comes again",
            [](R & r) -> auto& { return r.outcome.status; }),
        column_of(
            "reaction_time", "s", "from the stimulus to the answer", [](R & r) -> auto& { return r.outcome.reaction; }),
        column_of(
            "contact_time", "s", "in contact", [](R & r) -> auto& { return r.outcome.contact; }),
        column_of(
            "largest_force", "N", "displayed", [](R & r) -> auto& { return r.outcome.largest_force; }),
        column_of(
            "strokes", "", "passes across the whole feature", [](R & r) -> auto& { return r.outcome.strokes; }),
        column_of(
            "speed", "m/s", "mean in contact", [](R & r) -> auto& { return r.outcome.speed; }),
        column_of(
            "press", "N", "mean vertical force in contact", [](R & r) -> auto& { return r.outcome.press; }),
        column_of(
            "seed", "", "of what was random in the trial", [](R & r) -> auto& { return r.seed; }),
        column_of(
            "participant", "", "person, or which simulated one", [](R & r) -> auto& { return r.participant; }),
        column_of(
            "device", "", "that displayed the forces", [](R & r) -> auto& { return r.device; }),
        column_of(
            "program", "", "forceshade's version", [](R & r) -> auto& { return r.program; }),
        column_of(
            "started", "", "of the trial, UTC", [](R & r) -> auto& { return r.started; })};
    return columns;
}

std::string header() {
    CsvText text;
    for (const DataColumn& column : data_columns())
        text.add(column.name);
    text.end();
    return text.text();
}

void write_whole(const std::filesystem::path& file, std::string_view text) {
    TemporaryFile out(file);
    out.write(text);
    out.publish();
}

bool is_word(const std::string& text) {
    return !text.empty() && text.size() <= 64 && std::ranges::all_of(text, [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    });
}

std::string description(const Experiment& experiment) {
    Json variables = Json::array();
    for (const DataColumn& column : data_columns()) {
        Json variable{{"@type", "PropertyValue"}, {"name", column.name}, {"description", column.meaning}};
        if (*column.unit)
            variable["unitText"] = column.unit;
        variables.push_back(std::move(variable));
    }
    return Json{{"@context", "https://schema.org"},
                {"@type", "Dataset"},
                {"name", experiment.spec.title},
                {"description",
                 fmt::format(
                     "Answers to haptic stimuli: {} conditions, {} trials of each. {} Stimuli, order and question "
                     "stand in materials/.",
                     experiment.study.cases.size(), experiment.spec.trials, experiment.spec.question)},
                {"schemaVersion", "Psych-DS 0.4.0"},
                {"variableMeasured", std::move(variables)}}
               .dump(2) +
           "\n";
}

std::string readme(const Experiment& experiment) {
    return fmt::format(
        "# {}\n\nData of `forceshade experiment`, as a [Psych-DS](https://psych-ds.github.io/) folder: a "
        "row a trial in `data/`, the meaning of the columns in\n`dataset_description.json`, the "
        "experiment, its orders and its stimuli in `materials/`.\n\n    forceshade experiment analyse .\n",
        experiment.spec.title);
}

} // namespace

std::string utc_now() {
    const std::time_t now = std::time(nullptr);
    std::tm parts{};
    ::gmtime_r(&now, &parts);
    return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}Z", parts.tm_year + 1900, parts.tm_mon + 1, parts.tm_mday,
                       parts.tm_hour, parts.tm_min, parts.tm_sec);
}

std::vector<TrialRow> last_rows(const std::vector<TrialRow>& rows) {
    std::vector<TrialRow> last;
    for (const TrialRow& row : rows) {
        const auto same = std::ranges::find_if(last, [&](const TrialRow& one) {
            return one.number == row.number && one.session == row.session && one.subject == row.subject;
        });
        if (same == last.end())
            last.push_back(row);
        else
            *same = row;
    }
    return last;
}

std::vector<TrialRow> read_rows(const std::filesystem::path& file) {
    CsvReader csv(file);
    std::vector<TrialRow> rows;
    if (!csv.next())
        fail(csv.source(), {}, "has no header; it is no data of an experiment");
    std::vector<const DataColumn*> columns;
    for (std::size_t i = 0; i < csv.size(); ++i) {
        const auto known = std::ranges::find(data_columns(), csv.text(i), &DataColumn::name);
        columns.push_back(known == data_columns().end() ? nullptr : &*known);
    }
    for (const DataColumn& column : data_columns())
        if (std::ranges::find(columns, &column) == columns.end())
            fail(csv.source(), {1, 1}, "has no column \"{}\"; it is no data of an experiment", column.name);
    while (csv.next()) {
        if (csv.size() != columns.size())
            fail(csv.source(), csv.where(0),
                 "is damaged: {} cells, and the header has {}; repair the line, or delete it, and its trial is done "
                 "again",
                 csv.size(), columns.size());
        TrialRow row;
        for (std::size_t i = 0; i < columns.size(); ++i)
            if (columns[i] && !columns[i]->read(row, csv.text(i)))
                fail(csv.source(), csv.where(i),
                     "is damaged: \"{}\" is no {}; repair the line, or delete it, and its trial is done again",
                     csv.text(i), columns[i]->name);
        rows.push_back(std::move(row));
    }
    return rows;
}

std::vector<std::filesystem::path> data_files(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> files;
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(folder / "data", error))
        if (entry.path().filename().string().ends_with("_data.csv"))
            files.push_back(entry.path());
    if (files.empty())
        throw IoError(
            fmt::format("{} holds no data of an experiment: there is no data/*_data.csv in it", folder.string()));
    std::ranges::sort(files);
    return files;
}

SessionRecord::SessionRecord(const std::filesystem::path& folder, const Experiment& experiment, const SessionInfo& info)
    : folder_(folder), experiment_(experiment), info_(info), order_(trials_of(experiment, info.subject, info.session)) {
    if (!is_word(info.subject))
        throw UsageError(fmt::format("--subject \"{}\": a subject is letters and digits, as 03; it stands in names of "
                                     "files, and names no person",
                                     info.subject));
    write_materials();
    open_data();
    try {
        read_back();
    } catch (...) {
        ::close(descriptor_);
        throw;
    }
}

SessionRecord::~SessionRecord() {
    ::close(descriptor_);
}

std::string SessionRecord::stem() const {
    return fmt::format("subject-{}_session-{}", info_.subject, info_.session);
}

void SessionRecord::write_materials() const {
    const std::filesystem::path materials = folder_ / "materials", experiment_file = materials / "experiment.toml";
    const std::string toml = resolved_toml(experiment_);
    std::error_code error;
    if (std::filesystem::exists(experiment_file, error)) {
        if (read_file(experiment_file) != toml)
            throw UsageError(
                fmt::format("{} holds another experiment (materials/experiment.toml differs); name another "
                            "folder, or give the file that this folder was begun with",
                            folder_.string()));
    } else if (std::filesystem::exists(folder_, error) && !std::filesystem::is_empty(folder_, error)) {
        throw UsageError(fmt::format("{} is not empty and holds no experiment; name a new folder", folder_.string()));
    }
    std::filesystem::create_directories(folder_, error);
    for (const char* name : {"data", "materials", "paths"})
        make_subfolder(folder_, name);
    for (const char* name : {"order", "stimuli"})
        make_subfolder(materials, name);
    const std::filesystem::path order_file = materials / "order" / (stem() + ".csv");
    CsvText order;
    order.add("trial").add("block").add("condition").add("seed").end();
    for (const Trial& trial : order_)
        order.add(trial.number)
            .add(trial.block)
            .add(experiment_.study.cases[trial.condition].name)
            .add(trial.seed)
            .end();
    if (!std::filesystem::exists(order_file, error))
        write_whole(order_file, order.text());
    else if (read_file(order_file) != order.text())
        throw UsageError(fmt::format("{} is not the order that this program draws for subject {}, session {}; it was "
                                     "changed, or another version drew it. Name another session",
                                     order_file.string(), info_.subject, info_.session));
    if (std::filesystem::exists(experiment_file, error))
        return;
    for (const Case& one : experiment_.study.cases)
        write_whole(materials / "stimuli" / (one.name + ".toml"), forceshade::resolved_toml(one));
    write_whole(folder_ / "dataset_description.json", description(experiment_));
    write_whole(folder_ / "README.md", readme(experiment_));
    write_whole(experiment_file, toml); // last: with it the rest is there
}

void SessionRecord::open_data() {
    file_ = folder_ / "data" / (stem() + "_data.csv");
    descriptor_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    if (descriptor_ < 0)
        throw file_error("write", file_, errno);
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
        ::close(descriptor_);
        throw UsageError(fmt::format("{}: another run of this session is under way; end it, or name another session",
                                     file_.string()));
    }
}

// What was cut off is removed; then the rows.
void SessionRecord::read_back() {
    std::string text = read_file(file_);
    const std::size_t whole = text.rfind('\n') + 1; // 0: none
    if (whole < text.size()) {
        repaired_ = fmt::format("{}: the last line was cut off ({} bytes), so its trial is done again", file_.string(),
                                text.size() - whole);
        if (::ftruncate(descriptor_, static_cast<off_t>(whole)) != 0)
            throw file_error("write", file_, errno);
    }
    if (whole == 0) {
        const std::string first = header();
        if (::write(descriptor_, first.data(), first.size()) != std::ssize(first) || ::fdatasync(descriptor_) != 0)
            throw file_error("write", file_, errno);
        return;
    }
    rows_ = read_rows(file_);
    std::set<std::uint64_t> answered;
    for (const TrialRow& row : rows_) {
        const bool known = row.number >= 1 && row.number <= order_.size() && row.subject == info_.subject &&
                           row.session == info_.session &&
                           row.condition == experiment_.study.cases[order_[row.number - 1].condition].name;
        if (!known)
            throw UsageError(fmt::format("{}: row {} is of no trial of this session's order; the file was changed",
                                         file_.string(), row.sequence));
        if (row.outcome.status != kAnswered)
            answered.erase(row.number);
        else if (!answered.insert(row.number).second)
            throw UsageError(
                fmt::format("{}: trial {} was answered twice; delete one of its rows", file_.string(), row.number));
    }
    if (next() == nullptr)
        throw UsageError(fmt::format("session {} of subject {} is complete ({} trials); another one is --session {}",
                                     info_.session, info_.subject, order_.size(), info_.session + 1));
}

// The last row of each trial, in the order of these rows.
std::vector<const TrialRow*> SessionRecord::latest() const {
    std::vector<const TrialRow*> last;
    for (const TrialRow& row : rows_) {
        std::erase_if(last, [&](const TrialRow* one) { return one->number == row.number; });
        last.push_back(&row);
    }
    return last;
}

const Trial* SessionRecord::next() const {
    const std::vector<const TrialRow*> last = latest();
    for (const Trial& trial : order_)
        if (std::ranges::none_of(last, [&](const TrialRow* row) { return row->number == trial.number; }))
            return &trial;
    for (const TrialRow* row : last)
        if (row->outcome.status != kAnswered)
            return &order_[row->number - 1];
    return nullptr;
}

std::uint64_t SessionRecord::left() const {
    const std::vector<const TrialRow*> last = latest();
    return order_.size() - static_cast<std::uint64_t>(std::ranges::count_if(
                               last, [](const TrialRow* row) { return row->outcome.status == kAnswered; }));
}

bool SessionRecord::withdraw_last() {
    const std::vector<const TrialRow*> last = latest();
    for (auto row = last.rbegin(); row != last.rend(); ++row)
        if ((*row)->outcome.status == kAnswered) {
            TrialOutcome outcome;
            outcome.status = kWithdrawn;
            add(order_[(*row)->number - 1], outcome);
            return true;
        }
    return false;
}

void SessionRecord::note(const std::string& text) const {
    make_subfolder(folder_, "documentation");
    const std::filesystem::path file = folder_ / "documentation" / (stem() + "_notes.csv");
    const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    CsvText line;
    line.add(utc_now()).add(rows_.size()).add(text).end();
    const std::string& all = line.text();
    const bool whole = descriptor >= 0 && ::write(descriptor, all.data(), all.size()) == std::ssize(all) &&
                       ::fdatasync(descriptor) == 0;
    const int error = errno;
    if (descriptor >= 0)
        ::close(descriptor);
    if (!whole)
        throw file_error("write", file, error);
}

void SessionRecord::add(const Trial& trial, const TrialOutcome& outcome) {
    const Case& stimulus = experiment_.study.cases[trial.condition];
    TrialRow row;
    row.subject = info_.subject;
    row.session = info_.session;
    row.sequence = rows_.empty() ? 1 : rows_.back().sequence + 1;
    row.number = trial.number;
    row.block = trial.block;
    row.condition = stimulus.name;
    row.outcome = outcome;
    row.seed = trial.seed;
    row.participant = info_.participant;
    row.device = info_.device;
    row.program = version();
    row.started = outcome.started.empty() ? utc_now() : outcome.started;
    if (outcome.answer) {
        row.answer = experiment_.spec.answers[*outcome.answer].name;
        if (const auto right = experiment_.correct_answer(stimulus))
            row.correct = *right == *outcome.answer;
    }
    CsvText line;
    for (const DataColumn& column : data_columns())
        line.add(column.text(row));
    line.end();
    struct stat before {};
    const std::string& text = line.text();
    if (::fstat(descriptor_, &before) != 0)
        throw file_error("write", file_, errno);
    errno = ENOSPC; // of a short write
    if (::write(descriptor_, text.data(), text.size()) != std::ssize(text) || ::fdatasync(descriptor_) != 0) {
        const int error = errno;
        if (::ftruncate(descriptor_, before.st_size) != 0)
            remark("warning: {} ends in a part of a row\n", file_.string());
        throw file_error("write", file_, error);
    }
    rows_.push_back(std::move(row));
}

std::filesystem::path SessionRecord::path_file(const Trial& trial) const {
    std::size_t tries = 1;
    for (const TrialRow& row : rows_)
        tries += row.number == trial.number;
    return folder_ / "paths" /
           fmt::format("{}_trial-{}{}.csv", stem(), trial.number, tries > 1 ? fmt::format("_try-{}", tries) : "");
}

} // namespace forceshade::experiment
