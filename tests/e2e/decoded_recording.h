// A recording with everything that a source counts, and the output of the decoder alone for it:
// every input of the daemon must produce the same.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace rayloc::e2e {

// The first datagrams of device_los at ap2, uncompressed in `folder`, with one that comes twice,
// one that comes when its frame has been given on, and one that is no CSI among them.
struct CutRecording {
  std::filesystem::path file;
  std::size_t datagrams = 0;
};
CutRecording cut_recording(const std::filesystem::path& folder);

struct Decoded {
  // v1::CsiFrame without its time, as bytes, sorted: frames that wait for a time-out are released
  // later than frames that are complete.
  std::vector<std::string> frames;
  // As in SourceCounters, with "rejected." before the name of a reason.
  std::map<std::string, std::uint64_t> counters;
};
Decoded decode(const std::filesystem::path& recording);

// The counters of a heartbeat's source in JSON that Decoded also has.
std::map<std::string, std::uint64_t> counters_of(const nlohmann::json& counters);

}  // namespace rayloc::e2e
