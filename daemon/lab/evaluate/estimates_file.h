// Reads estimates written by `rayloc replay` and `rayloc sub`.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/expected.h"
#include "engine/room/location_estimate.h"

namespace rayloc {

struct PublishedEstimate {
  bool person = false;    // else a device
  bool filtered = false;  // else a snapshot
  std::string target;     // as in the topic
  LocationEstimate estimate;
};

// One JSON object per line, each a Location or an Envelope (whose other bodies are skipped), or
// Locations in protobuf, each after its length as a varint. Recognised by the first bytes; "-" is
// standard input. Returned in the order of the file. Errors name file:line:column or the byte.
Expected<std::vector<PublishedEstimate>> load_estimates(const std::filesystem::path& file);

// `name` denotes the file in errors.
Expected<std::vector<PublishedEstimate>> read_estimates(std::string_view content,
                                                        const std::string& name);

}  // namespace rayloc
