// The first lines of a report for people: its verdict in one sentence, and the next steps.
#pragma once

#include <string>
#include <vector>

namespace rayloc {

// HTML of plain text; without `steps` of the sentence alone.
std::string introduction(const std::string& sentence, const std::vector<std::string>& steps);

}  // namespace rayloc
