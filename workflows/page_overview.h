// workflows/page_overview.h -- the beginning of a report page: how it ended, what was found, where
// the time went; and what all of its parts name steps by.
#pragma once
#include "workflows/past_run.h"

#include <string>
#include <vector>

namespace sigmaflow::workflows {

std::string overview_html(const PastRun& run, const std::vector<Chapter>& chapters);

/// The anchor of a step of the page.
std::string step_id(std::size_t step);
std::string link_to_step(const PastRun& run, std::size_t step);
/// Links to its step, or to the first and the last one.
std::string chapter_name(const PastRun& run, const Chapter& chapter);
/// Of its finished steps.
double seconds_of(const PastRun& run, const Chapter& chapter);
std::string seconds_text(double seconds);

std::string parameter_html(const PastStep& step, const std::string& parameter);
/// An entry of an object as text, empty if there is none.
std::string text_at(const nlohmann::ordered_json& object, const std::string& key);

}
