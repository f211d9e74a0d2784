#include "daemon/pipeline/record/recording_folder.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <limits>
#include <string_view>
#include <system_error>
#include <thread>
#include <vector>

#include "capture/record/recording_repair.h"

namespace rayloc {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kSuffix = ".pcap";
constexpr std::string_view kStampShape = "-00000000T000000Z";

bool has_suffix(std::string_view text, std::string_view suffix) {
  return text.size() >= suffix.size() && text.substr(text.size() - suffix.size()) == suffix;
}

bool has_shape(std::string_view text, std::string_view shape) {
  return text.size() == shape.size() &&
         std::equal(text.begin(), text.end(), shape.begin(), [](char c, char s) {
           return s == '0' ? c >= '0' && c <= '9' : c == s;
         });
}

struct Recording {
  fs::path path;
  std::string key;
  std::uint64_t bytes = 0;
  bool part = false;
};

std::vector<Recording> recordings_in(const fs::path& folder) {
  std::vector<Recording> found;
  std::error_code gone;  // another recorder may remove a file meanwhile
  for (fs::directory_iterator entry(folder, gone), end; !gone && entry != end;
       entry.increment(gone)) {
    Recording recording{entry->path(), recording_age_key(entry->path()), 0, false};
    std::error_code failed;
    recording.bytes = entry->file_size(failed);
    recording.part = has_suffix(entry->path().native(), kPartSuffix);
    if (!recording.key.empty() && !failed) {
      found.push_back(std::move(recording));
    }
  }
  // "…Z-10" is younger than "…Z-9".
  std::sort(found.begin(), found.end(), [](const Recording& a, const Recording& b) {
    const std::size_t stamp = kStampShape.size() - 1;
    const int order = a.key.compare(0, stamp, b.key, 0, stamp);
    return order != 0 ? order < 0 : std::pair(a.key.size(), a.key) < std::pair(b.key.size(), b.key);
  });
  return found;
}

// The writer of a daemon that was just killed may still hold its file.
Expected<RecordingRepair> repair_patiently(const std::string& path, Timestamp now) {
  constexpr int kAttempts = 50;
  constexpr auto kPause = std::chrono::milliseconds(20);
  Expected<RecordingRepair> repair = repair_recording(path, now);
  for (int i = 0; i < kAttempts && repair && repair->result == RecordingRepair::Result::kInUse;
       ++i) {
    std::this_thread::sleep_for(kPause);
    repair = repair_recording(path, now);
  }
  return repair;
}

std::string outcome(const std::string& path, const RecordingRepair& repair) {
  switch (repair.result) {
    case RecordingRepair::Result::kInUse:
      return path + " is not changed: another process writes it";
    case RecordingRepair::Result::kEmpty:
      return path + " had no record in it and is removed";
    case RecordingRepair::Result::kRepaired:
      break;
  }
  return path + " was left behind and is repaired: " + std::to_string(repair.records) +
         " records, " + std::to_string(repair.cut_bytes) + " bytes cut off";
}

}  // namespace

std::string recording_stamp(Timestamp time) {
  const std::time_t seconds = std::chrono::duration_cast<std::chrono::seconds>(
                                  std::chrono::floor<std::chrono::seconds>(time).time_since_epoch())
                                  .count();
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y%m%dT%H%M%SZ", &utc);
  return text.data();
}

std::string recording_age_key(const fs::path& file) {
  const std::string name = file.filename().string();
  std::string_view stem = name;
  if (has_suffix(stem, kPartSuffix)) {
    stem.remove_suffix(std::string_view(kPartSuffix).size());
  }
  if (!has_suffix(stem, kSuffix)) {
    return {};
  }
  stem.remove_suffix(kSuffix.size());
  for (std::size_t at = 1; at + kStampShape.size() <= stem.size(); ++at) {
    if (!has_shape(stem.substr(at, kStampShape.size()), kStampShape)) {
      continue;
    }
    const std::string_view rest = stem.substr(at + kStampShape.size());
    const bool numbered = rest.size() > 1 && rest[0] == '-' &&
                          rest.find_first_not_of("0123456789", 1) == std::string_view::npos;
    if (rest.empty() || numbered) {
      return std::string(stem.substr(at + 1));
    }
  }
  return {};
}

fs::path free_recording_name(const fs::path& folder, const std::string& name, Timestamp time) {
  const std::string stem = name + "-" + recording_stamp(time);
  for (int number = 1;; ++number) {
    const std::string end = (number == 1 ? "" : "-" + std::to_string(number)) + ".pcap";
    fs::path path = folder / (stem + end);
    std::error_code unknown;
    if (!fs::exists(path, unknown) && !fs::exists(path.string() + kPartSuffix, unknown)) {
      return path;
    }
  }
}

Expected<void> make_recording_folder(const fs::path& folder) {
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed) {
    return make_error(ErrorKind::kUnavailable,
                      folder.string() + ": cannot be made: " + failed.message());
  }
  return {};
}

std::uint64_t remove_oldest_recordings(const fs::path& folder, std::uint64_t bytes) {
  const std::vector<Recording> all = recordings_in(folder);
  std::uint64_t total = 0;
  for (const Recording& recording : all) {
    total += recording.bytes;
  }
  std::uint64_t removed = 0;
  for (const Recording& recording : all) {
    std::error_code failed;
    if (total > bytes && !recording.part && fs::remove(recording.path, failed)) {
      total -= recording.bytes;
      ++removed;
    }
  }
  return removed;
}

std::vector<fs::path> recordings_since(const fs::path& folder,
                                       const std::string& name,
                                       Timestamp since) {
  std::vector<fs::path> found;
  for (const Recording& recording : recordings_in(folder)) {
    const std::string file = recording.path.filename().string();
    const bool is_its = file.rfind(name + "-" + recording.key + std::string(kSuffix), 0) == 0;
    std::error_code failed;
    const auto written = fs::last_write_time(recording.path, failed);
    if (is_its && !failed && std::chrono::file_clock::to_sys(written) >= since) {
      found.push_back(recording.path);
    }
  }
  return found;
}

std::uint64_t repair_recordings(const fs::path& folder,
                                Timestamp now,
                                const std::function<void(const std::string& line)>& log) {
  std::uint64_t repaired = 0;
  for (const Recording& recording : recordings_in(folder)) {
    if (!recording.part) {
      continue;
    }
    const Expected<RecordingRepair> repair = repair_patiently(recording.path.string(), now);
    log("recording: " +
        (repair ? outcome(recording.path.string(), *repair) : repair.error().message));
    const bool done = repair && repair->result == RecordingRepair::Result::kRepaired;
    repaired += done ? 1U : 0U;
  }
  return repaired;
}

std::uint64_t free_disk_bytes(const fs::path& folder) {
  std::error_code failed;
  const fs::space_info space = fs::space(folder, failed);
  return failed ? std::numeric_limits<std::uint64_t>::max() : space.available;
}

}  // namespace rayloc
