#include "capture/assemble/mixture_detector.h"

#include <algorithm>

namespace rayloc {
namespace {

// Counter steps of one access point: losses forward, reordered datagrams backward.
constexpr std::uint32_t kCounterTolerance = 64;
constexpr std::uint32_t kCounterModulus = 65536;
// A track without a new value for this long is removed.
constexpr Duration kTrackMemory = std::chrono::seconds(5);
// One 802.11 frame reaches two access points within its transmission time: a retransmission of it
// advances the counter by one, and kCounterTolerance frames take longer than this.
constexpr Duration kSameFrame = std::chrono::milliseconds(10);
// A counter returns to the range of an earlier one by chance once in 500 jumps.
constexpr int kMinReturns = 2;
// A route may change between two interfaces of one machine, and back.
constexpr int kMinSenderReturns = 4;
constexpr int kMinSharedRuns = 3;
// The parts of a frame arrive within this time; later ones belong to another frame.
constexpr Duration kFrameDuration = std::chrono::milliseconds(500);
constexpr Duration kCounterMemory = std::chrono::seconds(10);
// Runs of equal length: 44 of 78 in a recording in which most frames were retransmitted.
constexpr std::size_t kRuns = 24;
constexpr std::size_t kMinEqualRuns = 20;

Duration apart(Timestamp a, Timestamp b) { return a < b ? b - a : a - b; }

// Distance of two counter values on the circle of 16 bits.
std::uint32_t counter_distance(std::uint32_t a, std::uint32_t b) {
  const std::uint32_t forward = (a - b) % kCounterModulus;
  return std::min(forward, kCounterModulus - forward);
}

}  // namespace

std::string_view to_string(MixtureDetector::Evidence evidence) {
  switch (evidence) {
    case MixtureDetector::Evidence::kFrameCounters:
      return "two frame counters advance side by side";
    case MixtureDetector::Evidence::kSenders:
      return "two sender addresses alternate";
    case MixtureDetector::Evidence::kSharedCounter:
      return "one value of the frame counter comes with different CSI";
    case MixtureDetector::Evidence::kSequenceNumbers:
      return "every 802.11 sequence number comes several times with different CSI";
    case MixtureDetector::Evidence::kNone:
      break;
  }
  return "";
}

void MixtureDetector::observe(Evidence evidence, Timestamp time) {
  evidence_ = evidence;
  last_evidence_ = time;
}

bool MixtureDetector::follow(Tracks& all,
                             const Track& now,
                             std::uint32_t tolerance,
                             Timestamp time) {
  std::erase_if(all.tracks,
                [&](const Track& track) { return apart(track.time, time) > kTrackMemory; });
  const bool is_first = all.tracks.empty();
  bool has_newer = false;  // of the same transmitter
  for (std::size_t i = all.tracks.size(); i-- > 0;) {
    const Track& track = all.tracks[i];
    if (track.transmitter != now.transmitter) {
      continue;
    }
    if (track.value == now.value || counter_distance(track.value, now.value) < tolerance) {
      all.tracks.erase(all.tracks.begin() + static_cast<std::ptrdiff_t>(i));
      all.tracks.push_back(now);
      return has_newer;
    }
    has_newer = true;
  }
  if (all.tracks.size() == kMaxTracks) {
    all.tracks.erase(all.tracks.begin());
  }
  all.tracks.push_back(now);
  if (is_first || has_newer) {
    newest_beginning_ = time;
  }
  return false;
}

void MixtureDetector::add(const DatagramAddress& sender, Timestamp time) {
  if (is_mixture() && apart(time, last_evidence_) > kMemory) {
    reset();
  }
  Track track;
  track.value = sender.source_ip;
  track.time = time;
  if (follow(senders_, track, 0, time)) {
    senders_.returns = apart(time, senders_.last_return) > kTrackMemory ? 1 : senders_.returns + 1;
    senders_.last_return = time;
    if (senders_.returns >= kMinSenderReturns) {
      observe(Evidence::kSenders, time);
    }
  }
}

void MixtureDetector::add(const CsiFragment& fragment,
                          const DatagramAddress& sender,
                          Timestamp time) {
  add(sender, time);
  if (fragment.has_sequence) {
    add_counter(fragment, time);
    add_recent(fragment, time);
  } else if (!fragment.control_frame) {
    add_sequence_number(fragment, time);
  }
}

void MixtureDetector::add_counter(const CsiFragment& fragment, Timestamp time) {
  for (const Track& track : counters_.tracks) {
    if (track.transmitter == fragment.transmitter &&
        track.sequence_control == fragment.sequence_control &&
        apart(track.time, time) <= kSameFrame &&
        counter_distance(track.value, fragment.sequence) > kCounterTolerance) {
      observe(Evidence::kFrameCounters, time);
    }
  }
  const Track now{fragment.sequence, time, fragment.transmitter, fragment.sequence_control};
  if (follow(counters_, now, kCounterTolerance, time)) {
    counters_.returns =
        apart(time, counters_.last_return) > kTrackMemory ? 1 : counters_.returns + 1;
    counters_.last_return = time;
    if (counters_.returns >= kMinReturns) {
      observe(Evidence::kFrameCounters, time);
    }
  }
}

void MixtureDetector::add_recent(const CsiFragment& fragment, Timestamp time) {
  recent_.resize(kRecent);
  Recent& recent = recent_[fragment.sequence % kRecent];
  const bool same_counter = recent.used && recent.sequence == fragment.sequence &&
                            apart(recent.time, time) <= kCounterMemory;
  const bool same_transmitter = same_counter && recent.transmitter == fragment.transmitter;
  const bool same_frame = same_transmitter &&
                          recent.sequence_control == fragment.sequence_control &&
                          apart(recent.begin, time) <= kFrameDuration;
  if (!same_frame) {
    recent.used = true;
    recent.is_shared = same_transmitter;
    recent.begin = time;
    recent.sequence = fragment.sequence;
    recent.sequence_control = fragment.sequence_control;
    recent.transmitter = fragment.transmitter;
    recent.parts = 0;
  }
  recent.time = time;
  const Part part{static_cast<std::uint16_t>(slot_of(fragment.rx_chain, fragment.stream)),
                  fragment.first_tone,
                  fragment.digest};
  const auto end = recent.part.begin() + static_cast<std::ptrdiff_t>(recent.parts);
  const auto known = std::find_if(recent.part.begin(), end, [&](const Part& one) {
    return one.slot == part.slot && one.first_tone == part.first_tone;
  });
  if (known != end) {
    recent.is_shared = recent.is_shared || known->digest != part.digest;
  } else if (recent.parts < kRecentParts) {
    recent.part[recent.parts++] = part;
  }
  add_shared(fragment, recent.is_shared, time);
}

void MixtureDetector::add_shared(const CsiFragment& fragment, bool is_shared, Timestamp time) {
  if (is_shared != in_shared_run_) {
    // After a value that the previous recording lost, the step is forward; a mixture repeats one.
    const auto step = static_cast<std::uint16_t>(fragment.sequence - last_sequence_);
    if (is_shared && !(step > 0 && step <= kCounterTolerance)) {
      shared_runs_ = frames_in_run_ > kMaxNew ? 1 : shared_runs_ + 1;
    }
    in_shared_run_ = is_shared;
    frames_in_run_ = 1;
  } else if (fragment.sequence != last_sequence_) {
    frames_in_run_ = std::min(frames_in_run_ + 1, kMaxNew + 1);
  }
  last_sequence_ = fragment.sequence;
  if (is_shared && frames_in_run_ > kMaxShared) {
    shared_runs_ = 0;
  }
  if (is_shared && shared_runs_ >= kMinSharedRuns) {
    observe(Evidence::kSharedCounter, time);
  }
}

void MixtureDetector::add_sequence_number(const CsiFragment& fragment, Timestamp time) {
  const bool same_run = run_length_ > 0 && run_.transmitter == fragment.transmitter &&
                        run_.sequence_control == fragment.sequence_control;
  if (!same_run) {
    close_run();
    run_ = fragment;
    run_.words = {};
    run_begin_ = time;
    run_length_ = 1;
    run_digest_ = fragment.digest;
  } else if (fragment.rx_chain == run_.rx_chain && fragment.stream == run_.stream &&
             fragment.digest != run_digest_) {
    // Later repetitions belong to no run of a mixture.
    run_length_ = apart(run_begin_, time) <= kSameFrame ? run_length_ + 1 : 1;
    run_digest_ = fragment.digest;
  }
  if (runs_.size() < kRuns) {
    return;
  }
  const int length = runs_.back();
  const auto equal = std::count(runs_.begin(), runs_.end(), length);
  if (length >= 2 && static_cast<std::size_t>(equal) >= kMinEqualRuns) {
    observe(Evidence::kSequenceNumbers, time);
  }
}

void MixtureDetector::close_run() {
  if (run_length_ == 0) {
    return;
  }
  if (runs_.size() == kRuns) {
    runs_.erase(runs_.begin());
  }
  runs_.push_back(run_length_);
}

}  // namespace rayloc
