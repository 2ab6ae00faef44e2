// The two pages of a session at a device: the participant's and the operator's.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "host/experiment/experiment.h"
#include "host/server/page_server.h"

namespace forceshade::experiment {

constexpr const char *kParticipant = "participant", *kOperator = "operator"; /* names of the pages */

/// Both pages, and the pictures of answers that the participant's shows.
std::vector<ServedPage> session_pages(const ExperimentSpec& spec);

/// The question and its answers as the participant's page shows them: label, picture, and the device's button of each
/// if buttons answer, as many as answers.
nlohmann::ordered_json answers_on_page(const ExperimentSpec& spec, const std::vector<unsigned>& buttons);

/// For a page. Names are the vendors', and need not be UTF-8.
std::string page_message(const nlohmann::ordered_json& json);

} // namespace forceshade::experiment
