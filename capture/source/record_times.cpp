#include "capture/source/record_times.h"

#include <algorithm>
#include <utility>

#include "capture/source/clock_pairs.h"

namespace rayloc {
namespace {

// Maximum run of damaged stamps from one fault: a frame of four cores and four streams.
constexpr std::uint64_t kMaxDamaged = 16;
// Maximum at the beginning and the end of a file, where only one side can be compared.
constexpr std::uint64_t kMaxDamagedAtAnEnd = 3;
constexpr Duration kLongSilence = std::chrono::hours(24);

// Larger corrections are not applied: no sum of a stamp and two of them overflows.
constexpr Duration kMaxCorrection = Duration(std::int64_t{1} << 61U);

bool is_small(Duration correction) {
  return correction <= kMaxCorrection && correction >= -kMaxCorrection;
}

bool follows(Timestamp latest, Timestamp stamp, const StampLimits& limits) {
  return stamp >= latest - limits.disorder && stamp <= latest + limits.gap;
}

// True if `stamp` continues from `latest` when the records at `outside` are left out, and if a
// jump, not elapsed time, leads from `outside` to it.
bool comes_back(Timestamp latest, Timestamp outside, Timestamp stamp, const StampLimits& limits) {
  if (stamp < latest - limits.disorder) {
    return false;
  }
  return outside > latest ? stamp < outside - limits.disorder
                          : stamp - outside >= (latest - outside) / 2;
}

}  // namespace

void StampJudge::add(const RecordPlace& place, Timestamp stamp) {
  bool new_run = runs_.empty() || !follows(runs_.back().latest, stamp, limits_);
  if (!new_run && runs_.size() > 1) {
    const Run& before = runs_[runs_.size() - 2];
    const Run& run = runs_.back();
    new_run = run.records <= kMaxDamaged && run.latest < before.latest &&
              comes_back(before.latest, run.latest, stamp, limits_);
  }
  if (new_run) {
    if (!runs_.empty() && tail_outlies(runs_.back(), stamp)) {
      cut_tail();
    }
    runs_.push_back({place, place.packet, 0, stamp, stamp, stamp, {}, 0, {}, 0, {}, false});
  }
  Run& run = runs_.back();
  update_tail(run, stamp, place);
  run.last_packet = place.packet;
  ++run.records;
  run.earliest = std::min(run.earliest, stamp);
  run.latest = std::max(run.latest, stamp);
}

// Within a run time may advance by as much as a silence may last, also to a damaged
// stamp.
void StampJudge::update_tail(Run& run, Timestamp stamp, const RecordPlace& place) const {
  if (run.records > 0 && stamp > run.latest + limits_.disorder) {
    run.tail_place = place;
    run.tail_records = 0;
    run.tail_first = stamp;
    run.packet_before_tail = run.last_packet;
    run.latest_before_tail = run.latest;
  }
  run.tail_records += run.packet_before_tail > 0 ? 1U : 0U;
}

// True if the last few records of a run jumped ahead and `stamp` continues from the records before
// them: far nearer to those than the length of the jump. A clock that is set back after a pause
// seldom returns to that place.
bool StampJudge::tail_outlies(const Run& run, Timestamp stamp) const {
  constexpr int kFarNearer = 4;
  const Timestamp before = run.latest_before_tail;
  return run.tail_records > 0 && run.tail_records <= kMaxDamaged &&
         stamp >= before - limits_.disorder && stamp < run.tail_first - limits_.disorder &&
         kFarNearer * (stamp - before) <= run.tail_first - before;
}

// The tail of the last run becomes a separate run, which is damaged.
void StampJudge::cut_tail() {
  Run& run = runs_.back();
  Run tail{run.tail_place,
           run.last_packet,
           run.tail_records,
           run.tail_first,
           run.tail_first,
           run.latest,
           {},
           0,
           {},
           0,
           {},
           true};
  run.records -= run.tail_records;
  run.last_packet = run.packet_before_tail;
  run.latest = run.latest_before_tail;
  run.tail_records = 0;
  run.packet_before_tail = 0;
  runs_.push_back(tail);
}

bool StampJudge::continues(std::size_t before, std::size_t run) const {
  return follows(runs_[before].latest, runs_[run].first, limits_);
}

// True if a run that does not continue another one is outside: within a few records the time
// returns.
bool StampJudge::is_damaged(std::size_t before, std::size_t run) const {
  const Timestamp latest = runs_[before].latest;
  const Timestamp outside = runs_[run].first;
  std::uint64_t between = runs_[run].records;
  for (std::size_t next = run + 1; next < runs_.size() && between <= kMaxDamaged; ++next) {
    if (comes_back(latest, outside, runs_[next].first, limits_)) {
      // After a clock that was set back by little there may be a longer silence.
      const Duration back = latest - outside;
      return outside > latest || between <= kMaxDamagedAtAnEnd ||
             runs_[next].first - runs_[next - 1].latest <=
                 back + back / 2 + std::chrono::seconds(1);
    }
    between += runs_[next].records;
  }
  return false;
}

// A last record without a successor: from the past, or from far in the future.
bool StampJudge::is_odd_end(std::size_t before, std::size_t run) const {
  return run + 1 == runs_.size() && runs_[run].records <= kMaxDamagedAtAnEnd &&
         runs_[before].records > runs_[run].records &&
         (runs_[run].first < runs_[before].latest ||
          runs_[before].latest + kLongSilence < runs_[run].first);
}

// Skips a first run that lies in the future, or more than kLongSilence before the next run.
std::size_t StampJudge::first_run() const {
  if (runs_.size() < 2 || runs_[0].records > kMaxDamagedAtAnEnd ||
      runs_[0].records >= runs_[1].records || is_damaged(0, 1)) {
    return 0;
  }
  const bool ahead = runs_[0].latest > runs_[1].first;
  return ahead || runs_[0].latest + kLongSilence < runs_[1].first ? 1 : 0;
}

DamagedStamps StampJudge::damaged(std::size_t begin, std::size_t end, Timestamp around) const {
  DamagedStamps stamps{
      runs_[begin].place, runs_[end - 1].last_packet, 0, runs_[begin].first - around};
  for (std::size_t i = begin; i < end; ++i) {
    stamps.records += runs_[i].records;
  }
  return stamps;
}

// The pause is truncated to microseconds, the resolution of our recorder.
ClockJump StampJudge::jump_between(std::size_t before, std::size_t run) const {
  const Run& last = runs_[before];
  const Duration pause =
      last.records > 1
          ? std::chrono::floor<std::chrono::microseconds>(
                (last.latest - last.earliest) / static_cast<std::int64_t>(last.records - 1))
          : Duration::zero();
  return {runs_[run].place, last.latest, runs_[run].first, pause, false};
}

RecordTimes StampJudge::finish() const {
  RecordTimes times;
  if (runs_.empty()) {
    return times;
  }
  std::size_t before = first_run();
  if (before > 0) {
    times.damaged.push_back(damaged(0, before, runs_[before].first));
  }
  std::vector<std::size_t> kept = {before};
  for (std::size_t run = before + 1; run < runs_.size(); ++run) {
    if (runs_[run].outlies || !continues(before, run)) {
      if (runs_[run].outlies || is_damaged(before, run) || is_odd_end(before, run)) {
        times.damaged.push_back(damaged(run, run + 1, runs_[before].latest));
        continue;
      }
      times.jumps.push_back(jump_between(before, run));
    }
    before = run;
    kept.push_back(run);
  }
  if (!as_stamped_) {
    find_clocks_set(times);
  }
  fill_busy_times(kept, times);
  return times;
}

void StampJudge::find_clocks_set(RecordTimes& times) const {
  mark_clocks_set(times.jumps, limits_.gap);
  Duration correction{};
  for (ClockJump& jump : times.jumps) {
    jump.was_set =
        jump.was_set && is_small(jump.size()) && is_small(correction + jump.pause - jump.size());
    correction += jump.was_set ? jump.pause - jump.size() : Duration::zero();
  }
  times.correction = -correction;
}

void StampJudge::fill_busy_times(const std::vector<std::size_t>& kept, RecordTimes& times) const {
  RecordClock clock(times);
  for (const std::size_t index : kept) {
    const Run& run = runs_[index];
    const auto first = clock.event_time(run.place.packet, run.first);
    const Duration correction = first ? *first - run.first : Duration::zero();
    const TimeSpan span{run.earliest + correction, run.latest + correction};
    // Stamps that are used unchanged may go back.
    const bool follows_last = !times.busy.empty() &&
                              span.begin <= times.busy.back().end + limits_.gap &&
                              span.begin >= times.busy.back().begin;
    if (follows_last) {
      times.busy.back().end = std::max(times.busy.back().end, span.end);
    } else {
      times.busy.push_back(span);
    }
  }
  std::sort(times.busy.begin(), times.busy.end(), [](const TimeSpan& a, const TimeSpan& b) {
    return a.begin < b.begin;
  });
}

std::optional<Timestamp> RecordClock::event_time(std::uint64_t packet, Timestamp stamp) {
  while (next_damaged_ < times_.damaged.size() &&
         times_.damaged[next_damaged_].last_packet < packet) {
    ++next_damaged_;
  }
  if (next_damaged_ < times_.damaged.size() &&
      times_.damaged[next_damaged_].first.packet <= packet) {
    late_ = times_.damaged[next_damaged_].ahead < Duration::zero();
    return std::nullopt;
  }
  while (next_jump_ < times_.jumps.size() && times_.jumps[next_jump_].place.packet <= packet) {
    const ClockJump& jump = times_.jumps[next_jump_++];
    correction_ += jump.was_set ? jump.pause - jump.size() : Duration::zero();
  }
  return stamp + correction_;
}

StreamClock::Ruling StreamClock::scan(Timestamp stamp) {
  if (!latest_) {
    latest_ = stamp;
    return Ruling::kGive;
  }
  if (!held_ && follows(*latest_, stamp, limits_)) {
    latest_ = std::max(*latest_, stamp);
    return Ruling::kGive;
  }
  if (!held_) {
    held_ = stamp;
    return Ruling::kHold;
  }
  const Timestamp held = *std::exchange(held_, std::nullopt);
  late_ = held < *latest_;
  if (comes_back(*latest_, held, stamp, limits_)) {
    latest_ = std::max(*latest_, stamp);
    return Ruling::kDropHeld;
  }
  const Duration back = *latest_ - held;
  if (late_ && !as_stamped_ && is_small(back) && is_small(correction_ + back)) {
    correction_ += back;
  }
  latest_ = held;
  return Ruling::kGiveHeld;
}

bool StreamClock::give_at_end() {
  if (!held_) {
    return false;
  }
  const Timestamp held = *std::exchange(held_, std::nullopt);
  late_ = held < *latest_;
  return !late_ && held <= *latest_ + kLongSilence;
}

}  // namespace rayloc
