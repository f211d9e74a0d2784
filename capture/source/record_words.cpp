// Messages about the time stamps of a recording.
#include <algorithm>
#include <utility>

#include "capture/source/record_times.h"
#include "capture/source/seconds_text.h"

namespace rayloc {
namespace {

std::string at(const RecordPlace& place) {
  return "packet " + std::to_string(place.packet) + " (byte " + std::to_string(place.byte) + "): ";
}

// For a machine without a battery that has not received the time yet. No CSI recording is older.
std::string describe_unset_clock(const RecordTimes& times) {
  constexpr Timestamp kFirstPossible = std::chrono::sys_days(std::chrono::year(2000) / 1 / 1);
  if (times.of_counter || times.busy.empty() || times.busy.front().begin >= kFirstPossible) {
    return {};
  }
  const std::chrono::year_month_day date(
      std::chrono::floor<std::chrono::days>(times.busy.front().begin));
  return "its first time stamp is of the year " + std::to_string(static_cast<int>(date.year())) +
         ": the clock of the recording machine was not set, and the reported times have the same "
         "error";
}

std::string describe_damage(const DamagedStamps& stamps) {
  const bool late = stamps.ahead < Duration::zero();
  std::string words = at(stamps.first) + "its time stamp lies ";
  words += seconds_text(late ? -stamps.ahead : stamps.ahead);
  words += late ? " behind" : " ahead of";
  words += " its neighbours; ";
  words += stamps.records > 1 ? std::to_string(stamps.records) + " packets from there on are"
                              : std::string("it is");
  words += " left out (";
  return words + (late ? "time_went_back)" : "damaged_time)");
}

// For captures that were joined in another order than that of time; no clock was set.
std::string describe_joined(const ClockJump& jump, const RecordTimes& times) {
  constexpr std::uint64_t kNear = 16;  // the first packets of a capture may not be datagrams
  const auto after =
      std::find_if(times.joined.rbegin(), times.joined.rend(), [&](const RecordPlace& header) {
        return header.packet <= jump.place.packet && jump.place.packet < header.packet + kNear;
      });
  if (after == times.joined.rend() || jump.size() >= Duration::zero()) {
    return {};
  }
  return at(jump.place) + "the capture that begins at byte " + std::to_string(after->byte) +
         " starts " + seconds_text(-jump.size()) +
         " before the end of the one before it, and is taken to follow it: split the file there, "
         "and name the parts as several recordings of one access point";
}

std::string describe_clock(const ClockJump& jump, const RecordTimes& times) {
  if (std::string joined = describe_joined(jump, times); !joined.empty()) {
    return joined;
  }
  const Duration size = jump.size() - jump.pause;
  const bool back = size < Duration::zero();
  if (times.of_counter && back) {
    return at(jump.place) + "the card's counter went back by " + seconds_text(-size) +
           ", as when the card starts anew; time goes on from the record before";
  }
  std::string words = at(jump.place) + "the clock was set ";
  words += back ? "back by " : "forward by ";
  words += seconds_text(back ? -size : size);
  if (jump.was_set) {
    words += "; all reported times use the setting of the clock at the ";
    words += times.streamed ? "beginning" : "end";
  }
  return words;
}

std::string describe_unit(const CaptureUnit& capture) {
  const bool nanoseconds = capture.shown == pcap::TimeUnit::kNanoseconds;
  std::string words = "byte " + std::to_string(capture.place.byte) + ": ";
  words +=
      nanoseconds
          ? "the pcap header states microseconds, but the time stamps hold nanoseconds: most of "
            "their sub-second values are above 999999; "
          : "the pcap header states nanoseconds, but the time stamps hold microseconds: their "
            "sub-second values fill 0 to 999999 and end there; ";
  if (capture.misread && !nanoseconds) {
    return words +
           "a pipe is read as its header states: write the recording to a file, whose "
           "stamps are read as microseconds";
  }
  words += nanoseconds ? "they are read as nanoseconds; write such a file with the magic number "
                         "a1b23c4d"
                       : "they are read as microseconds; write such a file with the magic number "
                         "a1b2c3d4";
  return words;
}

std::string resolution_text(std::uint8_t resolution) {
  return ((resolution & 0x80U) != 0 ? "2^-" : "10^-") + std::to_string(resolution & 0x7fU) + " s";
}

// Messages about units of the stamps that the headers state wrongly.
std::vector<std::string> describe_units(const RecordTimes& times) {
  std::vector<std::string> words;
  std::size_t more = 0;
  for (const CaptureUnit& capture : times.units) {
    if (capture.shown != capture.stated && words.empty()) {
      words.push_back(describe_unit(capture));
    } else if (capture.shown != capture.stated) {
      ++more;
    }
  }
  if (more > 0) {
    words.front() += "; the same of " + std::to_string(more) + " more captures in the file";
  }
  if (const auto& wrong = times.misstated) {
    words.push_back("interface " + std::to_string(wrong->interface) +
                    " states time stamps in units of " + resolution_text(wrong->stated) +
                    " (if_tsresol), but those of " + std::to_string(wrong->packets) +
                    " packets are dates in units of " + resolution_text(wrong->read_as) +
                    " alone; they are read so; correct if_tsresol where the file is written");
  }
  return words;
}

}  // namespace

std::vector<std::string> describe(const RecordTimes& times,
                                  const std::string& name,
                                  Duration least_gap) {
  // For a file with many anomalies the first ones are sufficient.
  constexpr std::size_t kMaxLines = 3;
  const std::string file = name + ": ";
  std::vector<std::string> damaged;
  for (const DamagedStamps& stamps : times.damaged) {
    damaged.push_back(file + describe_damage(stamps));
  }
  std::vector<std::string> set;
  std::vector<const ClockJump*> gaps;
  for (const ClockJump& jump : times.jumps) {
    const Duration size = jump.size() - jump.pause;
    if (jump.was_set || size < Duration::zero()) {
      set.push_back(file + describe_clock(jump, times));
    } else if (size > least_gap) {
      gaps.push_back(&jump);
    }
  }
  std::vector<std::string> words;
  if (!times.joined.empty()) {
    const std::size_t more = times.joined.size() - 1;
    words.push_back(file + "byte " + std::to_string(times.joined.front().byte) +
                    ": another capture begins here, as cat joins files; it is read as well" +
                    (more > 0 ? ", and " + std::to_string(more) + " more behind it" : ""));
  }
  for (const std::string& line : describe_units(times)) {
    words.push_back(file + line);
  }
  for (const auto& [lines, what] : {std::pair(&damaged, " more such places"),
                                    std::pair(&set, " more times that the clock was set")}) {
    words.insert(words.end(),
                 lines->begin(),
                 lines->begin() + static_cast<std::ptrdiff_t>(std::min(lines->size(), kMaxLines)));
    if (lines->size() > kMaxLines) {
      words.push_back(file + std::to_string(lines->size() - kMaxLines) + what);
    }
  }
  if (const std::string year = describe_unset_clock(times); !year.empty()) {
    words.push_back(file + year);
  }
  const auto longest =
      std::max_element(gaps.begin(), gaps.end(), [](const ClockJump* a, const ClockJump* b) {
        return a->size() < b->size();
      });
  if (longest != gaps.end()) {
    words.push_back(
        file + at((*longest)->place) + "its time stamp is " + seconds_text((*longest)->size()) +
        " later than the one before: the clock was set, or nothing was received" +
        (gaps.size() > 1 ? " (the longest of " + std::to_string(gaps.size()) + " such gaps)" : ""));
  }
  return words;
}

}  // namespace rayloc
