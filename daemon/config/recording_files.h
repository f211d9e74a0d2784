// The files of a [[source]] of kind "pcap".
#pragma once

#include <string>
#include <vector>

#include "daemon/config/config.h"

namespace rayloc {

// What it names, with wildcards expanded. A pattern that no file matches stays as it is, to be
// named when it cannot be opened.
std::vector<std::string> recording_files(const SourceConfig& source);

}  // namespace rayloc
