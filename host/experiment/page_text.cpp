#include "host/experiment/page_text.h"

#include <algorithm>

namespace forceshade::experiment {
namespace {

// A head, its explanation and its hint have the name of the page's phase: `page/participant.html`.
constexpr PageText kTexts[] = {
    {"language", "en", "code of the page's language, for screen readers and line breaks"},
    {"space", "space", "name of the space bar"},
    {"progress", "trials done", "name of the bar of progress, for screen readers"},
    {"connecting", "Connecting …", "before the program answers"},
    {"consent_hint", "Press {space} if you agree. If you do not, say so to the operator.", "under the page of consent"},
    {"instructions_hint", "Press {space} to go on.", "under the page of instructions"},
    {"welcome", "Ready?", "before the first trial"},
    {"welcome_hint", "Press {space} to begin.", "before the first trial"},
    {"familiar", "This is “{answer}”.", "while an answer's stimulus is made known"},
    {"familiar_hint", "Feel it as long as you like, then press {space}.", "while an answer's stimulus is made known"},
    {"lift", "Lift the probe off the surface.", "before a stimulus"},
    {"next_hint", "The next shape is on its way.", "before a stimulus"},
    {"first_on_its_way", "The first shape is on its way.", "before the first of two"},
    {"second_on_its_way", "The second shape is on its way.", "before the second of two"},
    {"hold_button", "Hold button {button} of the device.", "before a stimulus, with a dead-man's button"},
    {"first", "This is the first.", "while the first of two is displayed"},
    {"first_hint", "Press {space} for the second.", "while the first of two is displayed"},
    {"first_timed_hint", "The second follows by itself.", "while the first of two is displayed for a time"},
    {"second", "This is the second.", "while the second of two is displayed"},
    {"interval_over", "It is over.", "once the second of two was displayed for its time"},
    {"answer_hint", "Press the key of your answer: {first} to {last}.", "while a stimulus is displayed"},
    {"answer_buttons_hint", "Press the key of your answer, {first} to {last}, or the device's button.",
     "while a stimulus is displayed, with buttons that answer"},
    {"button", "button {button}", "at an answer that a button gives"},
    {"answered", "Thank you.", "after an answer"},
    {"right", "Right.", "after an answer, with feedback"},
    {"wrong", "Not quite.", "after an answer, with feedback"},
    {"no_contact", "Please touch the shape before you answer.", "after an answer without contact"},
    {"too_early", "Please take a little longer to feel the shape.", "after an answer within least_contact"},
    {"again_hint", "The shape comes again later.", "after such an answer"},
    {"pause", "Pause.", "in a pause"},
    {"pause_hint", "Press {space} to go on.", "in a pause"},
    {"page_closed", "The page was closed.", "in a pause, as its reason"},
    {"page_silent", "The page did not answer.", "in a pause, as its reason"},
    {"operator_paused", "The operator has paused the experiment.", "in a pause, as its reason"},
    {"operator_hint", "It goes on when the operator says so.", "in a pause that the operator ends"},
    {"rest", "Time for a break.", "in a break"},
    {"rest_wait", "You can go on in {seconds} s.", "in a break that is still too short"},
    {"rest_hint", "Press {space} when you want to go on.", "in a break"},
    {"done", "That was all. Thank you!", "at the end"},
    {"done_hint", "You may close this page.", "at the end"},
    {"over", "The experiment was stopped.", "once the program has ended"},
    {"over_hint", "Please speak to the operator.", "once the program has ended"},
    {"taken", "This experiment is open in another window.", "in a second window"},
    {"taken_hint", "Close this one.", "in a second window"},
};

} // namespace

std::span<const PageText> page_texts() {
    return kTexts;
}

const PageText* page_text(std::string_view key) {
    const auto* const found = std::ranges::find(kTexts, key, &PageText::key);
    return found == std::end(kTexts) ? nullptr : found;
}

std::string unknown_word(const PageText& sentence, std::string_view text) {
    for (std::size_t open = text.find('{'); open != text.npos; open = text.find('{', open + 1)) {
        const std::size_t close = text.find('}', open);
        const std::string_view word = text.substr(open, close == text.npos ? close : close + 1 - open);
        if (close == text.npos || sentence.english.find(word) == sentence.english.npos)
            return std::string(word);
    }
    return "";
}

std::map<std::string, std::string> texts_with(const std::map<std::string, std::string>& own) {
    std::map<std::string, std::string> all = own;
    for (const PageText& one : kTexts)
        all.try_emplace(std::string(one.key), one.english);
    return all;
}

} // namespace forceshade::experiment
