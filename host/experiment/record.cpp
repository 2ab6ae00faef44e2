#include "host/experiment/record.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <ctime>
#include <fcntl.h>
#include <functional>
#include <set>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/clock.h"
#include "host/error.h"
#include "host/output/files.h"
#include "host/output/json.h"
#include "host/output/raw_formats.h"
#include "host/paths/path_reader.h"
#include "host/program.h"
#include "host/text.h"

namespace forceshade::experiment {
namespace {

using namespace std::string_view_literals;

template <typename T> bool parsed(std::string_view text, T& value) {
    const std::optional<T> number = number_in<T>(text);
    value = number.value_or(value);
    return number.has_value();
}

// A column of the data: what stands in it, and how it is read back. `read` is false for what it cannot be.
struct DataColumn {
    const char* name;
    const char* unit;
    const char* meaning;
    std::function<std::string(const TrialRow&)> text;
    std::function<bool(TrialRow&, std::string_view)> read;
    bool (*is_of)(const ExperimentSpec&) = nullptr; // experiments that have it; null: all
    bool needed = true;                             // else older data may lack it
};

// A member of the row, or of its outcome.
template <typename T, typename Whole>
DataColumn column_of(const char* name, const char* unit, const char* meaning, T Whole::*member) {
    const auto part = [member](auto& row) -> auto& {
        if constexpr (std::is_same_v<Whole, TrialOutcome>)
            return row.outcome.*member;
        else
            return row.*member;
    };
    if constexpr (std::is_same_v<T, std::string>)
        return {name, unit, meaning, [part](const TrialRow& row) { return part(row); },
                [part](TrialRow& row, std::string_view text) {
                    part(row) = text;
                    return true;
                }};
    else
        return {name, unit, meaning, [part](const TrialRow& row) { return fmt::format("{}", part(row)); },
                [part](TrialRow& row, std::string_view text) { return parsed(text, part(row)); }};
}

DataColumn of_some(DataColumn column, bool (*is_of)(const ExperimentSpec&)) {
    column.is_of = is_of;
    return column;
}

DataColumn optional(DataColumn column) {
    column.needed = false;
    return column;
}

const std::vector<DataColumn>& all_columns() {
    using R = TrialRow;
    using O = TrialOutcome;
    const auto compares = [](const ExperimentSpec& spec) { return spec.task == Task::compare; };
    const auto tracks = [](const ExperimentSpec& spec) { return !spec.track.empty(); };
    static const std::vector<DataColumn> columns{
        {"row_id", "", "subject, session and sequence",
         [](const R& r) { return fmt::format("{}-{}-{}", r.subject, r.session, r.sequence); },
         [](R&, std::string_view text) { return !text.empty(); }},
        column_of("subject", "", "as given at the start", &R::subject),
        column_of("session", "", "of the subject, from 1 on", &R::session),
        column_of("sequence", "", "of the trials as they were done, from 1 on", &R::sequence),
        column_of("trial", "", "number in the order that was drawn before; one that failed comes again", &R::number),
        column_of("block", "", "from 1 on; 0: practice", &R::block),
        column_of("condition", "", "name of the stimulus", &R::condition),
        of_some(column_of("standard", "", "name of the stimulus that it was compared with", &R::standard), compares),
        of_some(column_of("standard_interval", "",
                          "1: the standard was felt first, 2: second; reaction_time is from the second stimulus, all "
                          "else of both",
                          &R::standard_interval),
                compares),
        of_some(column_of("track", "", "the adaptive track that chose the stimulus; empty: practice", &R::track),
                tracks),
        column_of("answer", "", "name of the answer; empty: none", &R::answer),
        {"correct", "",
         "1: it names the stimulus' nominal shape, or the stimulus that is right, 0: it does not; empty: no answer is "
         "right",
         [](const R& r) { return std::string(r.correct ? (*r.correct ? "1" : "0") : ""); },
         [](R& r, std::string_view text) {
             if (!text.empty())
                 r.correct = text == "1";
             return text.empty() || text == "1" || text == "0";
         }},
        column_of("status", "", "answered, or why the trial does not count and comes again", &O::status),
        column_of("reaction_time", "s", "from the stimulus to the answer", &O::reaction),
        column_of("contact_time", "s", "in contact", &O::contact),
        column_of("largest_force", "N", "displayed", &O::largest_force),
        optional(column_of("limited", "",
                           "share of the time in contact in which the force was lowered for the motors' sake",
                           &O::limited)),
        column_of("strokes", "", "passes across the whole feature", &O::strokes),
        column_of("speed", "m/s", "mean in contact", &O::speed),
        column_of("press", "N", "mean vertical force in contact", &O::press),
        column_of("seed", "", "of what was random in the trial", &R::seed),
        column_of("participant", "", "person, or which simulated one", &R::participant),
        column_of("device", "", "that displayed the forces", &R::device),
        column_of("program", "", "forceshade's version", &R::program),
        column_of("started", "", "of the trial, UTC", &O::started),
        optional(
            column_of("answered_by", "", "key of the page or button of the device; empty: neither", &O::answered_by)),
        optional(column_of("device_check", "", "of the device before the session: passed, or none was made",
                           &R::device_check))};
    return columns;
}

std::vector<DataColumn> columns_of(const Experiment& experiment) {
    std::vector<DataColumn> columns;
    for (const DataColumn& column : all_columns())
        if (!column.is_of || column.is_of(experiment.spec))
            columns.push_back(column);
    return columns;
}

std::string header(const Experiment& experiment) {
    CsvText text;
    for (const DataColumn& column : columns_of(experiment))
        text.add(column.name);
    text.end();
    return text.text();
}

// All of it, onto the disk.
bool write_durably(int descriptor, std::string_view text) {
    return ::write(descriptor, text.data(), text.size()) == std::ssize(text) && ::fdatasync(descriptor) == 0;
}

// Whether a folder's experiment means what `resolved` does: keys that this program has and that one's had not are at
// their defaults, and comments mean nothing.
bool is_same(const std::string& kept, const std::filesystem::path& file, const std::string& resolved) {
    if (kept == resolved)
        return true;
    try {
        return resolved_toml(parse_experiment(kept, file.string(), file.parent_path())) == resolved;
    } catch (const UsageError&) {
        return false; // a later version's, or damaged
    }
}

bool is_word(const std::string& text) {
    return !text.empty() && text.size() <= 64 && std::ranges::all_of(text, [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    });
}

std::string description(const Experiment& experiment) {
    Json variables = Json::array();
    for (const DataColumn& column : columns_of(experiment)) {
        Json variable{{"@type", "PropertyValue"}, {"name", column.name}, {"description", column.meaning}};
        if (*column.unit)
            variable["unitText"] = column.unit;
        variables.push_back(std::move(variable));
    }
    return Json{{"@context", "https://schema.org"},
                {"@type", "Dataset"},
                {"name", experiment.spec.title},
                {"description",
                 fmt::format("Answers to haptic stimuli: {} conditions, {} trials of each{}. {} Stimuli, order and "
                             "question stand in materials/.",
                             experiment.asked().size(), experiment.spec.trials,
                             experiment.tracks.empty() ? "" : fmt::format(" track over {}", experiment.track_key),
                             experiment.spec.question)},
                {"schemaVersion", "Psych-DS 1.5.1"},
                {"variableMeasured", std::move(variables)}}
               .dump(2) +
           "\n";
}

std::string readme(const Experiment& experiment) {
    return fmt::format(
        "# {}\n\nData of `forceshade experiment`, as a [Psych-DS](https://psych-ds.github.io/) folder: a row a trial "
        "in `data/`, the meaning of the columns in\n`dataset_description.json`, the experiment, its orders and its "
        "stimuli in `materials/`.\n\n    forceshade experiment analyse .\n",
        experiment.spec.title);
}

// One process at a time sets a folder up; what one that was ended left behind, or one whose disk was full, is made
// anew.
class SetUp {
public:
    explicit SetUp(const std::filesystem::path& folder) : mark_(folder / ".unfinished") {
        std::error_code error;
        std::filesystem::create_directories(folder, error);
        folder_ = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
        if (folder_ < 0)
            throw file_error("open", folder, errno);
        while (::flock(folder_, LOCK_EX) != 0 && errno == EINTR)
            continue;
    }
    ~SetUp() { ::close(folder_); }
    SetUp(const SetUp&) = delete;
    SetUp& operator=(const SetUp&) = delete;

    bool was_begun() const { return std::filesystem::exists(mark_); }
    void begin() const {
        write_file_atomically(mark_, "forceshade sets this folder up; if it stays, start the session again\n");
    }
    void end() const {
        std::error_code error;
        std::filesystem::remove(mark_, error);
    }

private:
    const std::filesystem::path mark_;
    int folder_;
};

// Whether the file's header names these columns, however a spreadsheet ends its lines and quotes its cells.
bool has_columns(const std::filesystem::path& file, const std::vector<DataColumn>& columns) {
    CsvReader csv(file);
    std::vector<std::string> names;
    if (csv.next())
        for (std::size_t i = 0; i < csv.size(); ++i)
            names.emplace_back(csv.text(i));
    return std::ranges::equal(names, columns, {}, {}, &DataColumn::name);
}

} // namespace

std::vector<ThresholdTrack> unanswered_tracks(const Experiment& experiment) {
    std::vector<ThresholdTrack> tracks;
    for (const Track& track : experiment.tracks)
        tracks.emplace_back(track.levels, track.rises);
    return tracks;
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

std::vector<TrialRow> read_rows(const std::filesystem::path& file, const Experiment* experiment) {
    std::vector<std::string> answers;
    if (experiment)
        for (const Answer& answer : experiment->spec.answers)
            answers.push_back(answer.name);
    CsvReader csv(file);
    std::vector<TrialRow> rows;
    if (!csv.next())
        fail(csv.source(), {}, "has no header; it is no data of an experiment");
    std::vector<const DataColumn*> columns;
    for (std::size_t i = 0; i < csv.size(); ++i) {
        const auto known = std::ranges::find(all_columns(), csv.text(i), &DataColumn::name);
        columns.push_back(known == all_columns().end() ? nullptr : &*known);
    }
    for (const DataColumn& column : all_columns())
        if (column.needed && !column.is_of && std::ranges::find(columns, &column) == columns.end())
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
        if (experiment && row.outcome.status == kAnswered && std::ranges::find(answers, row.answer) == answers.end())
            fail(csv.source(),
                 csv.where(static_cast<std::size_t>(
                     std::ranges::find_if(columns, [](const DataColumn* c) { return c && c->name == "answer"sv; }) -
                     columns.begin())),
                 "is damaged: \"{}\" is no answer of this experiment ({}); repair the line, or delete it, and its "
                 "trial is done again",
                 row.answer, fmt::join(answers, ", "));
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
        throw IoError("{} holds no data of an experiment: there is no data/*_data.csv in it", folder.string());
    std::ranges::sort(files);
    return files;
}

SessionRecord::SessionRecord(const std::filesystem::path& folder, const Experiment& experiment, const SessionInfo& info)
    : folder_(folder), experiment_(experiment), info_(info), order_(trials_of(experiment, info.subject, info.session)),
      unanswered_(unanswered_tracks(experiment)), tracks_(unanswered_), ended_(unanswered_.size()) {
    if (!is_word(info.subject))
        throw UsageError("--subject \"{}\": a subject is letters and digits, as 03; it stands in names of files, and "
                         "names no person",
                         info.subject);
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
    const auto require_same = [&](const std::string& name, bool same) {
        if (!same)
            throw UsageError("{} holds another experiment (materials/{} differs); name another folder, or give the "
                             "file that this folder was begun with",
                             folder_.string(), name);
    };
    const SetUp set_up(folder_);
    const bool is_set_up = std::filesystem::exists(experiment_file, error);
    if (is_set_up) {
        require_same("experiment.toml", is_same(read_file(experiment_file), experiment_file, toml));
        for (const auto& [name, bytes] : given_files(experiment_.spec))
            require_same(name, read_file(materials / name) == bytes);
    } else if (!set_up.was_begun()) {
        if (!std::filesystem::is_empty(folder_, error))
            throw UsageError("{} is not empty and holds no experiment; name a new folder", folder_.string());
        set_up.begin();
    }
    for (const char* name : {"data", "materials", "paths"})
        make_subfolder(folder_, name);
    for (const char* name : {"order", "stimuli"})
        make_subfolder(materials, name);
    const std::filesystem::path order_file = materials / "order" / (stem() + ".csv");
    const bool compares = experiment_.spec.task == Task::compare;
    CsvText order;
    order.add("trial").add("block").add("condition");
    if (compares)
        order.add("standard_interval");
    if (!experiment_.tracks.empty())
        order.add("track");
    order.add("seed").end();
    for (const Trial& trial : order_) {
        order.add(trial.number).add(trial.block);
        order.add(trial.track ? "" : experiment_.stimulus(experiment_.conditions[trial.condition]).name);
        if (compares)
            order.add(trial.standard_first ? 1 : 2);
        if (!experiment_.tracks.empty())
            order.add(trial.track ? experiment_.tracks[*trial.track].name : "");
        order.add(trial.seed).end();
    }
    if (!std::filesystem::exists(order_file, error))
        write_file_atomically(order_file, order.text());
    else if (read_file(order_file) != order.text())
        throw UsageError("{} is not the order that this program draws for subject {}, session {}; it was changed, or "
                         "another version drew it. Name another session",
                         order_file.string(), info_.subject, info_.session);
    if (is_set_up)
        return;
    for (const Case& one : experiment_.study.cases)
        write_file_atomically(materials / "stimuli" / (one.name + ".toml"), forceshade::resolved_toml(one));
    for (const auto& [name, bytes] : given_files(experiment_.spec))
        write_file_atomically(materials / name, bytes);
    write_file_atomically(folder_ / "dataset_description.json", description(experiment_));
    write_file_atomically(folder_ / "README.md", readme(experiment_));
    write_file_atomically(folder_ / ".psychds-ignore", "paths/\n"); // tables of samples, not of answers
    write_file_atomically(experiment_file, toml);                   // last: with it the rest is there
    set_up.end();
}

void SessionRecord::open_data() {
    file_ = folder_ / "data" / (stem() + "_data.csv");
    descriptor_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    if (descriptor_ < 0)
        throw file_error("write", file_, errno);
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
        ::close(descriptor_);
        throw UsageError("{}: another run of this session is under way; end it, or name another session",
                         file_.string());
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
        if (!write_durably(descriptor_, header(experiment_)))
            throw file_error("write", file_, errno);
        return;
    }
    if (!has_columns(file_, columns_of(experiment_)))
        throw UsageError("{}: its columns are not those that this program writes, an older one began it; finish it "
                         "with that, or name another session",
                         file_.string());
    rows_ = read_rows(file_, &experiment_);
    std::set<std::uint64_t> answered;
    for (const TrialRow& row : rows_) {
        if (!trial_of(row))
            throw UsageError("{}: row {} is of no trial of this session's order; the file was changed", file_.string(),
                             row.sequence);
        if (row.outcome.status != kAnswered)
            answered.erase(row.number);
        else if (!answered.insert(row.number).second)
            throw UsageError("{}: trial {} was answered twice; delete one of its rows", file_.string(), row.number);
    }
    update_tracks();
    if (!next())
        throw UsageError("session {} of subject {} is complete ({} trials); another one is --session {}", info_.session,
                         info_.subject, answered.size(), info_.session + 1);
}

// With the condition that the row says, if that is one of its track's; nothing: it is of no trial of this session.
std::optional<Trial> SessionRecord::trial_of(const TrialRow& row) const {
    if (row.number < 1 || row.number > order_.size() || row.subject != info_.subject || row.session != info_.session)
        return std::nullopt;
    Trial trial = order_[row.number - 1];
    const auto is_of_row = [&](std::size_t condition) {
        return experiment_.stimulus(experiment_.conditions[condition]).name == row.condition;
    };
    if (trial.track) {
        const Track& track = experiment_.tracks[*trial.track];
        const auto found = std::ranges::find_if(track.conditions, is_of_row);
        if (found == track.conditions.end())
            return std::nullopt;
        trial.condition = *found;
    }
    return is_of_row(trial.condition) ? std::optional(trial) : std::nullopt;
}

void SessionRecord::update_tracks() {
    tracks_ = unanswered_;
    ended_.assign(tracks_.size(), false);
    for (const TrialRow* row : latest())
        learn(*row);
}

void SessionRecord::learn(const TrialRow& row) {
    const std::optional<Trial> trial = trial_of(row);
    if (!trial->track || !row.counts() || !row.correct)
        return;
    const std::vector<std::size_t>& conditions = experiment_.tracks[*trial->track].conditions;
    ThresholdTrack& track = tracks_[*trial->track];
    track.add(static_cast<std::size_t>(std::ranges::find(conditions, trial->condition) - conditions.begin()),
              *row.correct);
    const Range range = track.threshold().range;
    ended_[*trial->track] = range.high < experiment_.spec.track_ratio * range.low;
}

// The last row of each trial, in the order of these rows.
std::vector<const TrialRow*> SessionRecord::latest() const {
    std::vector<const TrialRow*> last;
    std::set<std::uint64_t> seen;
    for (auto row = rows_.rbegin(); row != rows_.rend(); ++row)
        if (seen.insert(row->number).second)
            last.push_back(&*row);
    std::ranges::reverse(last);
    return last;
}

std::optional<Trial> SessionRecord::next() const {
    const std::vector<const TrialRow*> last = latest();
    std::set<std::uint64_t> begun;
    for (const TrialRow* row : last)
        begun.insert(row->number);
    const auto chosen = [&](Trial trial) {
        if (trial.track)
            trial.condition = experiment_.tracks[*trial.track].conditions[tracks_[*trial.track].next()];
        return trial;
    };
    for (const Trial& trial : order_)
        if (!begun.contains(trial.number) && !has_ended(trial))
            return chosen(trial);
    for (const TrialRow* row : last)
        if (comes_again(*row))
            return chosen(order_[row->number - 1]);
    return std::nullopt;
}

// Withdrawals and pauses are people's choices, and count for nothing.
bool SessionRecord::comes_again(const TrialRow& last) const {
    const auto failed = [](const TrialRow& row) {
        return row.outcome.status != kAnswered && row.outcome.status != kWithdrawn &&
               row.outcome.status != "interrupted";
    };
    if (last.outcome.status == kAnswered || has_ended(order_[last.number - 1]))
        return false;
    return !failed(last) || std::ranges::count_if(rows_, [&](const TrialRow& row) {
                                return row.number == last.number && failed(row);
                            }) <= static_cast<std::ptrdiff_t>(experiment_.spec.max_repeats);
}

std::vector<std::string> SessionRecord::given_up() const {
    std::vector<std::string> trials;
    for (const TrialRow* row : latest())
        if (row->outcome.status != kAnswered && !has_ended(order_[row->number - 1]) && !comes_again(*row))
            trials.push_back(fmt::format("trial {} ({})", row->number, row->outcome.status));
    return trials;
}

std::uint64_t SessionRecord::left() const {
    std::set<std::uint64_t> done;
    for (const TrialRow* row : latest())
        if (row->outcome.status == kAnswered || !comes_again(*row))
            done.insert(row->number);
    return static_cast<std::uint64_t>(std::ranges::count_if(
        order_, [&](const Trial& trial) { return !done.contains(trial.number) && !has_ended(trial); }));
}

bool SessionRecord::withdraw_last() {
    const std::vector<const TrialRow*> last = latest();
    for (auto row = last.rbegin(); row != last.rend(); ++row)
        if ((*row)->outcome.status == kAnswered) {
            TrialOutcome outcome;
            outcome.status = kWithdrawn;
            add(*trial_of(**row), outcome);
            return true;
        }
    return false;
}

void SessionRecord::note(const std::string& text) const {
    CsvText line;
    line.add(utc_now()).add(rows_.size()).add(text).end();
    document(stem() + "_notes.csv", line.text());
}

void SessionRecord::keep_device(const std::string& json) const {
    document(stem() + "_device.jsonl", json + "\n");
}

void SessionRecord::keep_participant(const ParticipantFacts& facts) const {
    CsvText header, line;
    header.add("subject").add("session").add("age_years").add("hand").end();
    line.add(info_.subject).add(info_.session).add(facts.age ? std::to_string(*facts.age) : "").add(facts.hand).end();
    const std::filesystem::path file = folder_ / "documentation" / "participants.csv";
    const SetUp alone(folder_); // two rigs may start at once
    std::error_code error;
    const std::string before = std::filesystem::exists(file, error) ? read_file(file) : "";
    const std::string session = fmt::format("\n{},{},", info_.subject, info_.session);
    if (before.find(session) == before.npos) // of an earlier start
        document("participants.csv", before.empty() ? header.text() + line.text() : line.text());
}

// Adds a line to a file in documentation/.
void SessionRecord::document(const std::string& name, const std::string& line) const {
    make_subfolder(folder_, "documentation");
    const std::filesystem::path file = folder_ / "documentation" / name;
    const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    const bool whole = descriptor >= 0 && write_durably(descriptor, line);
    const int error = errno;
    if (descriptor >= 0)
        ::close(descriptor);
    if (!whole)
        throw file_error("write", file, error);
}

void SessionRecord::add(const Trial& trial, const TrialOutcome& outcome) {
    const Condition& condition = experiment_.conditions[trial.condition];
    TrialRow row;
    static_cast<SessionInfo&>(row) = info_;
    row.sequence = rows_.empty() ? 1 : rows_.back().sequence + 1;
    row.number = trial.number;
    row.block = trial.block;
    row.condition = experiment_.stimulus(condition).name;
    if (condition.standard) {
        row.standard = experiment_.study.cases[*condition.standard].name;
        row.standard_interval = trial.standard_first ? 1 : 2;
    }
    if (trial.track)
        row.track = experiment_.tracks[*trial.track].name;
    row.outcome = outcome;
    if (outcome.started.empty())
        row.outcome.started = utc_now();
    row.seed = trial.seed;
    row.program = version();
    if (outcome.answer) {
        row.answer = experiment_.spec.answers[*outcome.answer].name;
        if (const auto right = experiment_.correct_answer(trial))
            row.correct = *right == *outcome.answer;
    }
    CsvText line;
    for (const DataColumn& column : columns_of(experiment_))
        line.add(column.text(row));
    line.end();
    struct stat before {};
    if (::fstat(descriptor_, &before) != 0)
        throw file_error("write", file_, errno);
    errno = ENOSPC; // of a short write
    if (!write_durably(descriptor_, line.text())) {
        const int error = errno;
        if (::ftruncate(descriptor_, before.st_size) != 0)
            print_note("warning: {} ends in a part of a row\n", file_.string());
        throw file_error("write", file_, error);
    }
    rows_.push_back(std::move(row));
    if (outcome.status == kAnswered)
        learn(rows_.back());
    else
        update_tracks();
}

std::filesystem::path SessionRecord::path_file(const Trial& trial, std::size_t interval) const {
    std::size_t tries = 1;
    for (const TrialRow& row : rows_)
        tries += row.number == trial.number;
    return folder_ / "paths" /
           fmt::format("{}_trial-{}{}{}.csv", stem(), trial.number, tries > 1 ? fmt::format("_try-{}", tries) : "",
                       interval > 0 ? fmt::format("_interval-{}", interval) : "");
}

} // namespace forceshade::experiment
