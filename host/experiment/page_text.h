// The sentences of a participant's page: English, or as [experiment.text] has them in any language.
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>

namespace forceshade::experiment {

/// A sentence. Words in braces stand for something: {space} for the key's name, {button} for a button's number.
struct PageText {
    std::string_view key, english;
    std::string_view place; /* where it is read */
};

/// All that a page can say besides question, answers and pages of the experiment's own.
std::span<const PageText> page_texts();

/// By key; null: there is no such sentence.
const PageText* page_text(std::string_view key);

/// The first word in braces that the sentence cannot fill in; empty: it can fill in all.
std::string unknown_word(const PageText& sentence, std::string_view text);

/// Every sentence by its key, those of `own` in place of the English.
std::map<std::string, std::string> texts_with(const std::map<std::string, std::string>& own);

} // namespace forceshade::experiment
