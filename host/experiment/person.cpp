#include "host/experiment/run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <optional>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "device/backends/devices.h"
#include "device/loop/live_loop.h"
#include "device/session/session.h"
#include "host/clock.h"
#include "host/error.h"
#include "host/experiment/session_pages.h"
#include "host/output/json.h"
#include "host/program.h"
#include "host/server/page_server.h"
#include "shaders/shared/law.h"

namespace forceshade::experiment {
namespace {

constexpr double kBuffered = 16;        // s: of samples between two looks
constexpr double kFreeOfContact = 0.05; // s: without contact before a stimulus is displayed
constexpr double kSilence = 1.5;        // s: without a sign of life the page counts as closed
constexpr double kThanks = 0.4;         // s: after an answer
constexpr double kFeedback = 1.2;       // s
constexpr auto kLook = std::chrono::milliseconds(2);
constexpr double kOperatorEach = 0.1; // s
constexpr std::uint32_t kHeldBack = device::kDeadMan | device::kClutched;

// What a page sent under a key, or nothing if it is no text.
std::string text_of(const Json& json, const char* key) {
    const auto found = json.find(key);
    return found != json.end() && found->is_string() ? found->get<std::string>() : "";
}

class Person final : public Participant {
public:
    Person(const Experiment& experiment, const PersonOptions& options)
        : experiment_(experiment), first_(stimulus_of(experiment)),
          opened_(device::open_for_loop(options.session, first_)),
          ring_(static_cast<std::size_t>(kBuffered * opened_.settings.rate)),
          loop_(*opened_.device, make_probe_law(first_, 1 / opened_.settings.rate), opened_.settings, &ring_),
          buttons_(options.buttons),
          server_(session_pages(experiment.spec), options.port, [this](const std::string& page) { closed(page); }),
          emergency_(*opened_.device), signals_(loop_) {
        require_buttons();
        require_check(options.check);
        for (const std::string& warning : opened_.warnings)
            print_note("warning: {}\n", warning);
        warn_of_instability(options.session);
        warn_of_lasting_force();
        if (!manner_.empty())
            print_note("{}\n", manner_);
        loop_.suspend(true);
        loop_.start();
        print_note("participant's page: {}\noperator's page:    {}\n", server_.address(kParticipant),
                   server_.address(kOperator));
    }

    ~Person() override {
        loop_.suspend(true);
        loop_.stop();
        loop_.join();
        opened_.device->halt();
    }

    std::string device() const override { return opened_.facts.name; }
    std::string about_device() const override {
        const device::LoopSettings& settings = opened_.settings;
        Json json{{"started", utc_now()},
                  {"name", opened_.facts.name},
                  {"software", opened_.facts.software},
                  {"remark", opened_.facts.remark},
                  {"rate_Hz", settings.rate},
                  {"max_force_N", settings.limits.max_force},
                  {"manner", manner_},
                  {"dead_man", settings.dead_man},
                  {"clutch", settings.clutch},
                  {"answer_buttons", buttons_},
                  {"check", check_}};
        return page_message(json);
    }

    TrialOutcome take(const Trial& trial, std::span<const Shown> shown, SessionRecord& record) override {
        record_ = &record;
        trial_ = &trial;
        if (!block_)
            begin();
        else if (*block_ != trial.block || is_break_due())
            rest();
        block_ = trial.block;
        since_break_ += trial.is_practice() ? 0 : 1;
        TrialOutcome outcome;
        for (const Shown& one : shown) {
            const bool is_first = &one == &shown.front(), is_last = &one == &shown.back();
            condition_ = one.stimulus.one.name;
            do {
                if (!is_first && paused_) { // what was felt first is forgotten
                    outcome.status = "interrupted";
                    return outcome;
                }
                load(one.stimulus, !is_first);
            } while (!until_free());
            const TrialOutcome of_one = feel(one.stimulus, is_last);
            if (is_first)
                outcome = of_one;
            else
                add_interval(outcome, of_one);
            if (!one.path.empty() && !samples_.empty())
                log_path(samples_, one.path, one.stimulus.one.scene.precision, opened_.facts.buttons > 0);
            if (outcome.status != kAnswered) {
                say_why(outcome);
                return outcome;
            }
        }
        thank(outcome, trial);
        return outcome;
    }

    void finish() override {
        enter("done");
        look_for(kThanks);
    }

private:
    // Of the case that is furthest above its limit.
    void warn_of_instability(const device::SessionOptions& session) const {
        CasePreparation preparation;
        double worst = 0;
        std::size_t unstable = 0;
        std::string warning;
        for (const Case& one : experiment_.study.cases) {
            const PreparedCase prepared = preparation.prepare(one);
            const SceneLimits limits = limits_on(opened_, stroked(prepared, manner_of(prepared.one.scene)));
            if (limits.stable())
                continue;
            ++unstable;
            if (const double above = limits.stiffness / limits.limit(); above > worst) {
                worst = above;
                warning = fmt::format("{}: {}", one.name, limits.warning());
            }
        }
        refuse_unstable(warning, opened_, session);
        if (unstable > 0)
            print_note("warning: cases that are unstable: {} of {}; {}\n", unstable, experiment_.study.cases.size(),
                       warning);
    }

    // Forces that are lowered for the motors' sake are data, and no fault: of each row they are the column `limited`.
    void warn_of_lasting_force() const {
        const double most = opened_.settings.limits.continuous_force; // N
        double stiffest = 0;                                          // N/m
        for (const Case& one : experiment_.study.cases)
            stiffest = std::max(stiffest, one.scene.force.stiffness);
        if (std::isfinite(most) && stiffest > 0)
            print_note("note: {} displays {:.3g} N for long, which {:.3g} N/mm has {:.2g} mm deep; who presses more "
                       "feels less after some seconds, and the data say so (limited)\n",
                       opened_.facts.name, most, stiffest / 1e3, 1e3 * most / stiffest);
    }

    static PreparedCase stimulus_of(const Experiment& experiment) {
        const PreparedCase first = CasePreparation().prepare(experiment.study.cases.front());
        return stroked(first, manner_of(first.one.scene)); // for a simulated hand
    }

    void require_buttons() const {
        const device::LoopSettings& settings = opened_.settings;
        const std::size_t answers = experiment_.spec.answers.size();
        if (!buttons_.empty() && buttons_.size() != answers)
            throw UsageError("--answer-buttons: {} answers want as many buttons, got {}", answers, buttons_.size());
        for (const unsigned button : buttons_) {
            if (button > opened_.facts.buttons)
                throw UsageError("--answer-buttons: {} has no button {}", opened_.facts.name, button);
            if (std::ranges::count(buttons_, button) > 1 || button == settings.dead_man || button == settings.clutch)
                throw UsageError("--answer-buttons: button {} cannot be two things", button);
        }
    }

    // Of this device as it is used now, and passed.
    void require_check(const std::string& text) {
        if (text.empty()) {
            if (!opened_.facts.simulated)
                print_note("warning: {} was not checked before this session: forceshade device check, or --check now\n",
                           opened_.facts.name);
            return;
        }
        check_ = Json::parse(text, nullptr, false);
        const Json device = check_.is_object() && check_.contains("device") ? check_["device"] : Json();
        if (!device.is_object() || !check_.contains("passed") || !check_["passed"].is_boolean())
            throw UsageError("--check: this is no outcome of forceshade device check");
        if (text_of(device, "name") != opened_.facts.name)
            throw UsageError("--check: it is of {}, and this session's device is {}", text_of(device, "name"),
                             opened_.facts.name);
        if (text_of(check_, "manner") != manner_)
            throw UsageError("--check: it was made with another mapping or other buttons ({}); this session's: {}",
                             text_of(check_, "manner"), manner_);
        if (!check_["passed"].get<bool>())
            throw Error(ExitCode::failed,
                        fmt::format("--check: {} did not pass its check; see what it says to do, and check it again",
                                    opened_.facts.name));
    }

    // In a thread of the server's: the force is off with the next sample.
    void closed(const std::string& page) {
        if (page == kParticipant)
            loop_.suspend(true);
    }

    // `why`: the key of a sentence besides the phase's own; `values`: of words in braces, and what else the page needs.
    void enter(const char* phase, const std::string& why = {}, Json values = Json::object()) {
        phase_ = phase;
        why_ = why;
        values_ = std::move(values);
        tell_participant();
        tell_operator(true);
    }

    // Events of pages and samples of the loop, for a moment.
    void look() {
        std::this_thread::sleep_for(kLook);
        check_interrupt();
        while (const std::optional<PageEvent> event = server_.next_event())
            handle(*event);
        if (server_.is_open(kParticipant) && seconds_since(heard_) > kSilence)
            pause("page_silent");
        take_samples();
        tell_operator(false);
    }

    void look_for(double seconds) {
        for (const auto begin = Clock::now(); seconds_since(begin) < seconds;)
            look();
    }

    void handle(const PageEvent& event) {
        if (event.kind == PageEvent::Kind::opened) {
            heard_ = Clock::now();
            told_answers_ = told_answers_ && event.page != kParticipant;
            tell_participant();
            return tell_operator(true);
        }
        if (event.kind == PageEvent::Kind::closed) {
            if (event.page == kParticipant && !server_.is_open(kParticipant))
                pause("page_closed");
            return;
        }
        const Json json = Json::parse(event.text, nullptr, false);
        if (!json.is_object())
            return;
        const std::string type = text_of(json, "type");
        if (event.page == kParticipant)
            hear_participant(type, json);
        else
            hear_operator(type, text_of(json, "text"));
    }

    void hear_participant(const std::string& type, const Json& json) {
        heard_ = Clock::now();
        if (type == "go" && !held_ && Clock::now() >= rest_until_)
            go_ = true;
        const auto answer = json.find("answer"), sequence = json.find("sequence");
        if (type == "answer" && sequence != json.end() && sequence->is_number_unsigned() && *sequence == sequence_ &&
            answer != json.end() && answer->is_number_unsigned() && *answer < experiment_.spec.answers.size())
            accept(answer->get<std::size_t>(), "key");
    }

    // A button that goes down; one that is still held from before does nothing.
    void hear_buttons(std::uint32_t held) {
        const std::uint32_t pressed = held & ~std::exchange(held_buttons_, held);
        for (std::size_t i = 0; pressed != 0 && i < buttons_.size(); ++i)
            if ((pressed & device::button_bit(buttons_[i])) != 0)
                accept(i, "button");
    }

    // The first while a stimulus is felt: nothing pressed twice, or while loading.
    void accept(std::size_t answer, const char* by) {
        if (!asking_ || answer_)
            return;
        answer_ = answer;
        answered_by_ = by;
        answered_ = Clock::now();
    }

    void hear_operator(const std::string& type, const std::string& text) {
        if (type == "pause") {
            held_ = !held_;
            if (held_)
                pause("operator_paused");
            else if (phase_ == "pause")
                go_ = true; // elsewhere it is the participant's
            tell_participant();
        } else if (type == "repeat") {
            said_ = record_ && record_->withdraw_last() ? "The last trial comes again at the end."
                                                        : "There is no trial to repeat.";
        } else if (type == "note" && record_) {
            record_->note(text);
            said_ = "Noted.";
        } else if (type == "stop") {
            enter("over");
            throw Error(ExitCode::interrupted, "stopped by the operator; the same command goes on from here");
        }
        tell_operator(true);
    }

    void pause(const std::string& why) {
        loop_.suspend(true);
        paused_ = true;
        pause_why_ = why;
    }

    void begin() {
        const ExperimentSpec& spec = experiment_.spec;
        const bool is_new = record_->rows().empty();
        if (is_new && !spec.consent.bytes.empty()) {
            wait_for_go("consent");
            record_->note("the participant agreed to the page of consent");
        }
        if (!spec.instructions.bytes.empty())
            wait_for_go("instructions");
        if (is_new && spec.familiarise)
            familiarise();
        wait_for_go("welcome");
        rested_ = Clock::now();
    }

    bool is_break_due() const {
        const ExperimentSpec& spec = experiment_.spec;
        return (spec.break_every > 0 && since_break_ >= spec.break_every) ||
               (spec.break_after > 0 && seconds_since(rested_) >= spec.break_after);
    }

    void rest() {
        rest_until_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                         std::chrono::duration<double>(experiment_.spec.break_least));
        if (paused_) // it is the break
            wait_for_go("pause", pause_why_);
        else
            wait_for_go("rest");
        rest_until_ = {};
        since_break_ = 0;
        rested_ = Clock::now();
    }

    // Each answer with its first stimulus.
    void familiarise() {
        CasePreparation preparation;
        for (std::size_t answer = 0; answer < experiment_.spec.answers.size(); ++answer) {
            const Case* one = nullptr;
            for (const std::size_t condition : experiment_.asked())
                if (const Case& stimulus = experiment_.stimulus(experiment_.conditions[condition]);
                    !one && experiment_.correct_answer(stimulus) == answer)
                    one = &stimulus;
            if (!one)
                continue;
            const PreparedCase stimulus = preparation.prepare(*one);
            condition_ = one->name;
            do {
                do
                    load(stimulus, false);
                while (!until_free());
                go_ = false;
                show_force();
                enter("familiar", {}, {{"familiar", answer}});
                while (!go_ && !paused_) {
                    look();
                    require_device();
                }
                hide();
            } while (paused_);
        }
    }

    void wait_for_go(const char* phase, const std::string& why = {}) {
        loop_.suspend(true);
        go_ = false;
        enter(phase, why);
        while (!go_ || held_ || !server_.is_open(kParticipant))
            look();
        paused_ = false;
        require_device();
    }

    void require_device() const {
        if (loop_.end() != device::LoopEnd::running)
            throw device::DeviceAbsent("{} is gone{}; the same command goes on with the next trial", opened_.facts.name,
                                       error_text_of(*opened_.device));
    }

    // Hands over the law, without force.
    void load(const PreparedCase& stimulus, bool is_second) {
        if (paused_) {
            const Clock::time_point begun = Clock::now();
            wait_for_go("pause", pause_why_);
            const double least = experiment_.spec.break_least;
            if (least > 0 && seconds_since(begun) >= least) { // it was a break, too
                since_break_ = 0;
                rested_ = Clock::now();
            }
        }
        require_device();
        const unsigned dead_man = opened_.settings.dead_man;
        enter(is_second ? "between" : "loading", dead_man != 0 ? "hold_button" : "", {{"button", dead_man}});
        const std::uint32_t laws = loop_.status().laws;
        loop_.offer(make_probe_law(stimulus, 1 / opened_.settings.rate));
        while (loop_.status().laws == laws) {
            look();
            require_device();
        }
        from_path_ = loop_.status().law_path;
        samples_.clear();
    }

    // Waits until the probe has been free of contact for a while; false: the run was paused.
    bool until_free() {
        Clock::time_point touched = Clock::now();
        while (seconds_since(touched) < kFreeOfContact) {
            look();
            require_device();
            if (paused_)
                return false;
            if (loop_.status().depth > 0 || loop_.status().samples == 0 || opened_.device->withheld() != nullptr ||
                (loop_.status().flags & kHeldBack) != 0)
                touched = Clock::now();
        }
        return true;
    }

    void show_force() {
        loop_.suspend(false);
        displayed_ = true;
    }

    void hide() {
        loop_.suspend(true);
        displayed_ = false;
    }

    // The last stimulus of a trial is felt until it is answered, one before until a key is pressed; or for the
    // interval.
    TrialOutcome feel(const PreparedCase& stimulus, bool is_last) {
        ++sequence_;
        answer_.reset();
        go_ = false;
        take_samples();
        const std::size_t from = samples_.size();
        std::optional<std::size_t> to;
        const std::string started = utc_now();
        const Clock::time_point begin = Clock::now();
        show_force();
        enter(is_last ? "feel" : "first");
        asking_ = is_last;
        if (!server_.is_open(kParticipant)) // closed meanwhile: its suspend() may have come first
            pause("page_closed");
        const double interval = experiment_.spec.interval;
        bool late = false, over = false;
        while (!answer_ && !paused_ && !late && loop_.end() == device::LoopEnd::running) {
            look();
            late = seconds_since(begin) > experiment_.spec.longest_trial;
            if (!over && interval > 0 && seconds_since(begin) > interval) {
                hide();
                take_samples();
                to = samples_.size();
                over = true;
                if (is_last)
                    enter("feel", "interval_over");
            }
            if (!is_last && (interval > 0 ? over : go_))
                break;
        }
        hide();
        asking_ = false;
        take_samples();
        const std::vector<device::LiveSample> felt(samples_.begin() + static_cast<std::ptrdiff_t>(from),
                                                   samples_.begin() +
                                                       static_cast<std::ptrdiff_t>(to.value_or(samples_.size())));
        TrialOutcome outcome = outcome_of(feature_of(stimulus), felt, 1 / opened_.settings.rate);
        outcome.started = started;
        outcome.answer = answer_;
        if (answer_)
            outcome.answered_by = answered_by_;
        outcome.reaction = std::chrono::duration<double>((answer_ ? answered_ : Clock::now()) - begin).count();
        constexpr double kMissed = 0.02; // s: without force, of single samples
        bool clamped = false, let_go = false;
        std::size_t missed = 0;
        for (const device::LiveSample& sample : felt) {
            const bool touches = sample.facet != layout::kNoFacet;
            clamped = clamped || (sample.flags & (device::kClamped | device::kUnstable)) != 0;
            let_go = let_go || (touches && (sample.flags & (kHeldBack | device::kWithheld)) != 0);
            missed += touches && (sample.flags & device::kZeroForceFlags) != 0;
        }
        let_go = let_go || static_cast<double>(missed) > kMissed * opened_.settings.rate;
        if (loop_.end() != device::LoopEnd::running)
            outcome.status = "device lost";
        else if (paused_)
            outcome.status = "interrupted";
        else if (late)
            outcome.status = "no answer";
        else if (let_go)
            outcome.status = "force off";
        else if (clamped)
            outcome.status = "force clamped";
        else if (outcome.contact < experiment_.spec.least_contact)
            outcome.status = outcome.contact > 0 ? "too early" : "no contact";
        return outcome;
    }

    // To the participant, what to do another way; to the operator, what happened.
    void say_why(const TrialOutcome& outcome) {
        last_ = fmt::format("does not count: {}", outcome.status);
        if (outcome.status != "no contact" && outcome.status != "too early")
            return tell_operator(true);
        enter("again", outcome.status == "no contact" ? "no_contact" : "too_early");
        look_for(kFeedback);
    }

    void thank(const TrialOutcome& outcome, const Trial& trial) {
        last_ = experiment_.spec.answers[*outcome.answer].label;
        const bool right = experiment_.correct_answer(trial) == outcome.answer;
        enter(experiment_.spec.feedback ? "feedback" : "answered", right ? "right" : "wrong",
              {{"answer", *outcome.answer}});
        look_for(experiment_.spec.feedback ? kFeedback : kThanks);
    }

    void take_samples() {
        for (auto some = ring_.look(); !some.empty(); some = ring_.look()) {
            for (const device::LiveSample& sample : some) {
                hear_buttons(sample.buttons);
                if (sample.path >= from_path_)
                    samples_.push_back(sample);
                if (sample.tick % 20 == 0)
                    shown_.push_back({1e3 * sample.probe.x, sample.commanded.x, sample.commanded.z});
            }
            ring_.release(some.size());
        }
    }

    void tell_participant() {
        if (!server_.is_open(kParticipant))
            return;
        const double wait = std::chrono::duration<double>(rest_until_ - Clock::now()).count(); // s
        Json json{{"type", "state"},
                  {"phase", phase_},
                  {"why", why_},
                  {"sequence", sequence_},
                  {"wait", std::max(0.0, wait)},
                  {"operator", held_}};
        json.update(values_);
        if (record_) {
            json["total"] = record_->order().size();
            json["done"] = record_->order().size() - record_->left();
            json["trial"] = trial_->number;
        }
        if (!told_answers_) {
            json.update(answers_on_page(experiment_.spec, buttons_));
            told_answers_ = true;
        }
        server_.send(kParticipant, page_message(json));
    }

    void tell_operator(bool now) {
        if (!now && seconds_since(told_operator_) < kOperatorEach)
            return;
        told_operator_ = Clock::now();
        if (!server_.is_open(kOperator)) {
            shown_.clear();
            return;
        }
        const device::LoopStatus& status = loop_.status();
        const char* const withheld = opened_.device->withheld();
        const std::string happened = device::flag_names(status.flags, ", ");
        Json json{{"type", "state"},
                  {"phase", phase_},
                  {"title", experiment_.spec.title},
                  {"paused", held_},
                  {"said", said_},
                  {"last", last_},
                  {"manner", manner_.empty() ? "the device's space is the scene's" : manner_},
                  {"trouble", withheld != nullptr},
                  {"page", server_.is_open(kParticipant) ? "open" : "closed"},
                  {"device", fmt::format("{}, {:.0f} Hz, {} late samples", opened_.facts.name, opened_.settings.rate,
                                         status.overruns.load())},
                  {"safety", withheld != nullptr ? withheld
                             : !displayed_       ? "no force"
                             : happened.empty()  ? "on"
                                                 : happened},
                  {"force", fmt::format("{:.2f} N, {:.2f} mm", status.force.load(), 1e3 * status.depth.load())}};
        if (record_) {
            json["trial"] =
                fmt::format("{} of {} done; now number {}{}", record_->order().size() - record_->left(),
                            record_->order().size(), trial_->number, trial_->is_practice() ? ", practice" : "");
            json["condition"] = condition_;
        }
        server_.send(kOperator, page_message(json));
        if (!shown_.empty())
            server_.send(kOperator, page_message({{"type", "samples"}, {"samples", std::exchange(shown_, {})}}));
    }

    const Experiment& experiment_;
    const PreparedCase first_;
    device::OpenDevice opened_;
    device::SampleRing ring_;
    device::LiveLoop loop_;
    const std::string manner_ = device::manner_text(opened_.settings);
    const std::vector<unsigned> buttons_; // of the answers
    Json check_;                          // of the device; null: none
    PageServer server_;
    device::Emergency emergency_;
    device::LoopSignals signals_;

    SessionRecord* record_ = nullptr;
    const Trial* trial_ = nullptr;
    std::string condition_, phase_ = "connecting", why_, pause_why_, said_, last_;
    Json values_ = Json::object();
    std::optional<std::uint64_t> block_;
    std::uint64_t sequence_ = 0; // of stimuli, so that an answer belongs to one
    std::uint32_t from_path_ = 0;
    std::optional<std::size_t> answer_;
    std::string answered_by_;
    std::uint32_t held_buttons_ = 0; // of the last sample
    bool asking_ = false;            // a stimulus is felt
    Clock::time_point answered_, heard_, told_operator_;
    Clock::time_point rested_, rest_until_; // the last break's end; before then none ends
    std::uint64_t since_break_ = 0;         // trials
    bool go_ = false, paused_ = false, held_ = false, told_answers_ = false, displayed_ = false;
    std::vector<device::LiveSample> samples_;  // of the trial
    std::vector<std::array<double, 3>> shown_; // mm, N, N: for the operator
};

} // namespace

std::unique_ptr<Participant> make_person(const Experiment& experiment, const PersonOptions& options) {
    return std::make_unique<Person>(experiment, options);
}

} // namespace forceshade::experiment
