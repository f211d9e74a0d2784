// RecordTimes: which time stamps of a recording are accepted, and the event times they give.
//
// The records of a file are nearly in order of time. Exceptions have one of three
// causes:
//   - A few stamps are damaged: without them time continues as before. Damaged records are left
//     out, and do not affect any other record.
//   - The clock was set. Event time advances evenly, as that of live sources does (event_clock.h),
//     by the clock as it was at the end: a person who sets a clock sets it correctly. A backward
//     jump proves it; a forward jump only if it is undone at another place.
//   - Nothing was received for a while, or the clock was set forward: indistinguishable. The stamps
//     are kept, and a reader that keeps the recording's pace does not wait for it.
// A file is scanned before it is read (StampJudge, then RecordClock); of a pipe one record is held
// until the next one decides (StreamClock).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "capture/record/pcap_parser.h"
#include "engine/base/timestamp.h"

namespace rayloc {

// Silence longer than this may equally be a clock step; no reader waits for it.
constexpr Duration kMaxGap = std::chrono::seconds(10);

struct StampLimits {
  Duration disorder = std::chrono::milliseconds(100);  // of records from different receive queues
  Duration gap = kMaxGap;
};

// The place of a record.
struct RecordPlace {
  std::uint64_t packet = 0;  // number in the file, from 1 on
  std::uint64_t byte = 0;    // offset in the file, unpacked
};

struct DamagedStamps {
  RecordPlace first;
  std::uint64_t last_packet = 0;
  std::uint64_t records = 0;
  Duration ahead{};  // lead over the surrounding records; negative: behind
};

struct ClockJump {
  RecordPlace place;     // place of the first record after it
  Timestamp from;        // the latest stamp before it
  Timestamp to;          // the first stamp after it
  Duration pause{};      // estimated time between the two by an even clock
  bool was_set = false;  // a clock step; otherwise event time jumps as well

  Duration size() const { return to - from; }
};

struct TimeSpan {
  Timestamp begin;
  Timestamp end;
  friend bool operator==(const TimeSpan&, const TimeSpan&) = default;
};

// One of the classic captures that a file holds, and the unit of its time stamps.
struct CaptureUnit {
  RecordPlace place;  // place of its header; the packet is the first one after it
  pcap::TimeUnit stated = pcap::TimeUnit::kMicroseconds;
  pcap::TimeUnit shown = pcap::TimeUnit::kMicroseconds;
  bool misread = false;  // some stamps were read by another unit than the one shown
};

struct RecordTimes {
  std::vector<DamagedStamps> damaged;  // by place
  std::vector<ClockJump> jumps;        // by place
  Duration correction{};               // event time - stamp of the records before the first jump
  // In event time, in order: the periods with records, without gaps longer than StampLimits::gap.
  // Empty if there are none.
  std::vector<TimeSpan> busy;
  // For a stream, which cannot be scanned ahead: times use the clock as it was at the beginning;
  // neither `correction` nor `busy` is set.
  bool streamed = false;
  bool of_counter = false;          // stamps of a card's counter, which has no date
  std::vector<RecordPlace> joined;  // places of capture headers after the first one
  std::vector<CaptureUnit> units;
  std::optional<pcap::MisstatedResolution> misstated;  // for pcapng
};

// Determines them. Memory: some bytes for every gap.
class StampJudge {
 public:
  // `as_stamped`: event time is the stamp, regardless of clock steps.
  StampJudge(const StampLimits& limits, bool as_stamped)
      : limits_(limits), as_stamped_(as_stamped) {}

  // REQUIRES: records in the order of the file.
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
    // Its records since time last advanced within it; none while it never did.
    RecordPlace tail_place;
    std::uint64_t tail_records = 0;
    Timestamp tail_first;
    std::uint64_t packet_before_tail = 0;
    Timestamp latest_before_tail;
    bool outlies = false;  // the records after it continue from those before it
  };

  void update_tail(Run& run, Timestamp stamp, const RecordPlace& place) const;
  bool tail_outlies(const Run& run, Timestamp stamp) const;
  void cut_tail();
  bool continues(std::size_t before, std::size_t run) const;
  bool is_damaged(std::size_t before, std::size_t run) const;
  bool is_odd_end(std::size_t before, std::size_t run) const;
  std::size_t first_run() const;
  ClockJump jump_between(std::size_t before, std::size_t run) const;
  void find_clocks_set(RecordTimes& times) const;
  void fill_busy_times(const std::vector<std::size_t>& kept, RecordTimes& times) const;
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

  // Empty for a damaged stamp; is_late() then returns on which side it is.
  std::optional<Timestamp> event_time(std::uint64_t packet, Timestamp stamp);
  bool is_late() const { return late_; }

 private:
  const RecordTimes times_;
  Duration correction_;
  std::size_t next_damaged_ = 0;
  std::size_t next_jump_ = 0;
  bool late_ = false;
};

// The same for a stream. The caller keeps the held record.
class StreamClock {
 public:
  StreamClock(const StampLimits& limits, bool as_stamped)
      : limits_(limits), as_stamped_(as_stamped) {}

  enum class Ruling {
    kGive,      // return it by event_time()
    kHold,      // hold it until the next one is evaluated
    kDropHeld,  // the held record is damaged; return this one
    kGiveHeld,  // the held record is valid; return it, and evaluate this one again
  };
  Ruling scan(Timestamp stamp);
  // At the end of the input: true if the held record is to be returned.
  bool give_at_end();
  Timestamp event_time(Timestamp stamp) const { return stamp + correction_; }
  // True if the held record was behind the others.
  bool is_late() const { return late_; }
  // The latest stamp returned; defined once a record was held.
  Timestamp latest() const { return latest_.value_or(Timestamp{}); }

 private:
  const StampLimits limits_;
  const bool as_stamped_;
  std::optional<Timestamp> latest_;
  std::optional<Timestamp> held_;
  Duration correction_{};
  bool late_ = false;
};

// Descriptions for the operator, a line each; `name` is the file's. Gaps not longer than
// `least_gap` are omitted (record_words.cpp).
std::vector<std::string> describe(const RecordTimes& times,
                                  const std::string& name,
                                  Duration least_gap);

}  // namespace rayloc
