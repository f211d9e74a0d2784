// RecordTimes: which time stamps of a recording are believed, and what event times become of them.
//
// The records of a file are nearly in order of time. Where they are not, one of three things has
// happened:
//   - A few stamps are damaged: without them time goes on as it had gone before. What is damaged is
//     left out, and governs nothing else.
//   - The clock was set. Event time goes on evenly, as that of live sources does (event_clock.h),
//     and is told by the clock as it was at the end: whoever sets a clock sets it right. Time that
//     goes back proves it; time that goes forward only where it is undone elsewhere.
//   - Nothing was received for a while, or the clock was set forward: nobody can tell. The stamps
//     hold, and whoever keeps the recording's pace does not wait for it.
// A file is looked through before it is read (StampJudge, then RecordClock); of a pipe one record
// is held until the next one tells (StreamClock).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "capture/record/pcap_parser.h"
#include "engine/base/timestamp.h"

namespace rayloc {

// Silence that is longer than this may as well be a clock that was set; nobody waits for it.
constexpr Duration kMaxGap = std::chrono::seconds(10);

struct StampLimits {
  Duration disorder = std::chrono::milliseconds(100);  // of records of different receive queues
  Duration gap = kMaxGap;
};

// Where a record lies.
struct RecordPlace {
  std::uint64_t packet = 0;  // in the file, from 1 on
  std::uint64_t byte = 0;    // of the file, unpacked
};

struct DamagedStamps {
  RecordPlace first;
  std::uint64_t last_packet = 0;
  std::uint64_t records = 0;
  Duration ahead{};  // of the records around them; negative: behind
};

struct ClockJump {
  RecordPlace place;     // of the first record behind it
  Timestamp from;        // the latest stamp before it
  Timestamp to;          // the first one behind it
  Duration pause{};      // what had passed between the two by an even clock, as far as known
  bool was_set = false;  // the clock; else event time jumps as well

  Duration size() const { return to - from; }
};

struct TimeSpan {
  Timestamp begin;
  Timestamp end;
  friend bool operator==(const TimeSpan&, const TimeSpan&) = default;
};

// One of the classic captures that a file holds, and the unit of its time stamps.
struct CaptureUnit {
  RecordPlace place;  // of its header; the packet is the first one behind it
  pcap::TimeUnit stated = pcap::TimeUnit::kMicroseconds;
  pcap::TimeUnit shown = pcap::TimeUnit::kMicroseconds;
  bool misread = false;  // some stamps were read by another unit than the one shown
};

struct RecordTimes {
  std::vector<DamagedStamps> damaged;  // by place
  std::vector<ClockJump> jumps;        // by place
  Duration correction{};               // of the records before the first jump: event time - stamp
  // In event time, in order: when something was recorded, without the gaps that are longer than
  // StampLimits::gap. Empty where nothing was.
  std::vector<TimeSpan> busy;
  // Of a stream: nobody could look ahead, and times are told by the clock as it was at the
  // beginning; neither `correction` nor `busy` is known.
  bool streamed = false;
  bool of_counter = false;          // stamps of a card's counter, which has no date
  std::vector<RecordPlace> joined;  // headers of captures behind the first one
  std::vector<CaptureUnit> units;
  std::optional<pcap::MisstatedResolution> misstated;  // of pcapng
};

// Finds them. Memory: some bytes for every gap.
class StampJudge {
 public:
  // `as_stamped`: event time is what the stamps say, whoever set the clock.
  StampJudge(const StampLimits& limits, bool as_stamped)
      : limits_(limits), as_stamped_(as_stamped) {}

  // In the order of the file.
  void add(const RecordPlace& place, Timestamp stamp);
  RecordTimes finish() const;

 private:
  // Records that follow each other in time.
  struct Run {
    RecordPlace place;
    std::uint64_t last_packet = 0;
    std::uint64_t records = 0;
    Timestamp first;
    Timestamp earliest;
    Timestamp latest;
    // Its records since time last went ahead within it; none while it never did.
    RecordPlace tail_place;
    std::uint64_t tail_records = 0;
    Timestamp tail_first;
    std::uint64_t packet_before_tail = 0;
    Timestamp latest_before_tail;
    bool outlies = false;  // what comes behind it goes on from what came before it
  };

  void look_ahead(Run& run, Timestamp stamp, const RecordPlace& place) const;
  bool tail_outlies(const Run& run, Timestamp stamp) const;
  void cut_tail();
  bool continues(std::size_t before, std::size_t run) const;
  bool is_damaged(std::size_t before, std::size_t run) const;
  bool is_odd_end(std::size_t before, std::size_t run) const;
  std::size_t first_run() const;
  ClockJump jump_between(std::size_t before, std::size_t run) const;
  void find_clocks_set(RecordTimes& times) const;
  void tell_times(const std::vector<std::size_t>& kept, RecordTimes& times) const;
  DamagedStamps damaged(std::size_t begin, std::size_t end, Timestamp around) const;

  const StampLimits limits_;
  const bool as_stamped_;
  std::vector<Run> runs_;
};

// Applies them to the records of the file, one after the other.
class RecordClock {
 public:
  explicit RecordClock(RecordTimes times)
      : times_(std::move(times)), correction_(times_.correction) {}

  // Nothing for a damaged stamp; is_late() says on which side it lies then.
  std::optional<Timestamp> event_time(std::uint64_t packet, Timestamp stamp);
  bool is_late() const { return late_; }

 private:
  const RecordTimes times_;
  Duration correction_;
  std::size_t next_damaged_ = 0;
  std::size_t next_jump_ = 0;
  bool late_ = false;
};

// The same of a stream. The caller keeps the record that is held.
class StreamClock {
 public:
  StreamClock(const StampLimits& limits, bool as_stamped)
      : limits_(limits), as_stamped_(as_stamped) {}

  enum class Ruling {
    kGive,      // by event_time()
    kHold,      // until the next one is looked at
    kDropHeld,  // what was held is damaged; give this one
    kGiveHeld,  // what was held is right; give it, and look at this one again
  };
  Ruling look(Timestamp stamp);
  // Nothing comes any more: whether the record that is held is to be given.
  bool give_at_end();
  Timestamp event_time(Timestamp stamp) const { return stamp + correction_; }
  // Whether what was held lay behind the others.
  bool is_late() const { return late_; }
  // The latest stamp that was given; there is one once anything was held.
  Timestamp latest() const { return latest_.value_or(Timestamp{}); }

 private:
  const StampLimits limits_;
  const bool as_stamped_;
  std::optional<Timestamp> latest_;
  std::optional<Timestamp> held_;
  Duration correction_{};
  bool late_ = false;
};

// What people should know of them, a line each; `name` is the file's. Gaps that are no longer than
// `least_gap` are not spoken of (record_words.cpp).
std::vector<std::string> words_of(const RecordTimes& times,
                                  const std::string& name,
                                  Duration least_gap);

}  // namespace rayloc
