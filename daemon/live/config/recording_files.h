// The files of a [[source]] of kind "pcap".
#pragma once

#include <string>
#include <vector>

#include "daemon/live/config/config.h"

namespace rayloc {

// Its files, with wildcards expanded. A pattern that matches no file is kept, so that the error of
// opening it names it.
std::vector<std::string> recording_files(const SourceConfig& source);

}  // namespace rayloc
