#include "capture/assemble/frame_assembler.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "engine/base/check.h"

namespace rayloc {
namespace {

std::uint32_t blocks_of(const CsiFragment& fragment) {
  const std::size_t first = fragment.first_tone / kToneBlock;
  const std::size_t count = fragment.tones / kToneBlock;
  return static_cast<std::uint32_t>(((std::uint64_t{1} << count) - 1U) << first);
}

// Returns true if two fragments can belong to one frame.
bool agree(const CsiFragment& a, const CsiFragment& b) {
  return a.total_tones == b.total_tones && a.phy == b.phy && a.layout == b.layout &&
         a.transmitted_streams == b.transmitted_streams && a.expected_slots == b.expected_slots;
}

Duration distance(Timestamp a, Timestamp b) { return a < b ? b - a : a - b; }

}  // namespace

bool AssembledFrame::is_rectangular() const {
  for (std::size_t slot = 0; slot < kMaxSlots; ++slot) {
    if (has_slot(slot) && !is_whole(slot)) {
      return false;
    }
  }
  return true;
}

FrameAssembler::FrameAssembler(FrameAssemblerOptions options) : options_(std::move(options)) {
  RAYLOC_CHECK(options_.max_pending > 0);
  for (const std::uint8_t rx_chain : options_.expected_rx_chains) {
    RAYLOC_CHECK(rx_chain < kMaxRxChains);
  }
  pending_.reserve(options_.max_pending + 1);
  emitted_.reserve(kRemembered);
  emitted_keys_.reserve(kRemembered);
}

FrameAssembler::Key FrameAssembler::key_of(const CsiFragment& fragment) {
  Key key;
  for (const std::uint8_t octet : fragment.transmitter.octets) {
    key.address_and_sequence = key.address_and_sequence << 8U | octet;
  }
  key.address_and_sequence = key.address_and_sequence << 16U | fragment.sequence;
  key.rest = std::uint32_t{fragment.sequence_control} << 1U | (fragment.has_sequence ? 1U : 0U);
  return key;
}

FrameAssembler::Pending* FrameAssembler::find_pending(const Key& key) {
  // Searched from the newest, which is nearly always the match.
  const auto found = std::find_if(
      pending_.rbegin(), pending_.rend(), [&key](const Pending& p) { return p.key == key; });
  return found == pending_.rend() ? nullptr : &*found;
}

FrameAssembler::Emitted* FrameAssembler::find_emitted(const Key& key, Timestamp time) {
  Emitted* newest = nullptr;
  for (std::size_t i = 0; i < emitted_keys_.size(); ++i) {
    if (emitted_keys_[i] == key && distance(emitted_[i].time, time) <= kLateWindow &&
        (newest == nullptr || emitted_[i].time >= newest->time)) {
      newest = &emitted_[i];
    }
  }
  return newest;
}

FrameAssembler::Outcome FrameAssembler::judge_emitted(const CsiFragment& fragment,
                                                      Emitted& emitted,
                                                      Timestamp time) {
  const std::size_t slot = slot_of(fragment.rx_chain, fragment.stream);
  const std::uint32_t blocks = blocks_of(fragment);
  if ((emitted.coverage[slot] & blocks) != 0) {
    const bool same = fragment.has_sequence || emitted.digests[slot] == fragment.digest;
    return same ? Outcome::kDuplicate : Outcome::kAccepted;
  }
  // Without a frame counter the sequence control is ambiguous after a short time.
  if (!fragment.has_sequence && distance(emitted.time, time) > 2 * options_.timeout) {
    return Outcome::kAccepted;
  }
  emitted.coverage[slot] |= blocks;
  emitted.digests[slot] = fragment.digest;
  traffic_.slot_seen(fragment);
  return Outcome::kLate;
}

AssembledFrame& FrameAssembler::open(const Key& key, const CsiFragment& fragment, Timestamp time) {
  if (pending_.size() >= options_.max_pending) {
    close(0);
  }
  std::unique_ptr<AssembledFrame> frame;
  if (spare_.empty()) {
    frame = std::make_unique<AssembledFrame>();
  } else {
    frame = std::move(spare_.back());
    spare_.pop_back();
    std::vector<std::complex<float>> values = std::move(frame->values);
    *frame = {};
    frame->values = std::move(values);
  }
  frame->header = fragment;
  frame->header.words = {};
  frame->time = time;
  frame->time_last = time;
  frame->retry = traffic_.repeats_sequence_control(fragment);
  pending_.push_back({key, std::move(frame)});
  return *pending_.back().frame;
}

void FrameAssembler::add(AssembledFrame& frame, const CsiFragment& fragment, Timestamp time) {
  const std::size_t slot = slot_of(fragment.rx_chain, fragment.stream);
  const std::size_t total = frame.header.total_tones;
  if (!frame.has_slot(slot)) {
    frame.row_of_slot[slot] = frame.rows++;
    frame.slots = static_cast<std::uint16_t>(frame.slots | (1U << slot));
    if (frame.values.size() < frame.rows * total) {
      frame.values.resize(frame.rows * total);
    }
  }
  const std::span<std::complex<float>> values(frame.values);
  unpack_csi_words(
      fragment.layout,
      fragment.words,
      values.subspan(frame.row_of_slot[slot] * total + fragment.first_tone, fragment.tones));
  frame.coverage[slot] |= blocks_of(fragment);
  frame.digests[slot] = fragment.digest;
  for (std::size_t rx_chain = 0; rx_chain < kMaxRxChains; ++rx_chain) {
    if (!frame.header.power_dbm[rx_chain]) {
      frame.header.power_dbm[rx_chain] = fragment.power_dbm[rx_chain];
    }
  }
  frame.time = std::min(frame.time, time);
  frame.time_last = std::max(frame.time_last, time);
  ++frame.datagrams;
  ++datagrams_in_flight_;
}

FrameAssembler::Outcome FrameAssembler::push(const CsiFragment& fragment, Timestamp time) {
  const Key key = key_of(fragment);
  Pending* pending = find_pending(key);
  if (pending != nullptr) {
    const AssembledFrame& frame = *pending->frame;
    const std::size_t slot = slot_of(fragment.rx_chain, fragment.stream);
    const bool overlaps = (frame.coverage[slot] & blocks_of(fragment)) != 0;
    const bool agrees = agree(frame.header, fragment);
    if (fragment.has_sequence) {
      if (!agrees) {
        return Outcome::kMismatch;
      }
      if (overlaps) {
        return Outcome::kDuplicate;
      }
    } else if (!agrees || overlaps) {
      if (agrees && frame.digests[slot] == fragment.digest) {
        return Outcome::kDuplicate;
      }
      close(static_cast<std::size_t>(pending - pending_.data()));
      pending = nullptr;  // a retry of the same 802.11 frame
    }
  } else if (Emitted* emitted = find_emitted(key, time); emitted != nullptr) {
    const Outcome outcome = judge_emitted(fragment, *emitted, time);
    if (outcome != Outcome::kAccepted) {
      return outcome;
    }
  }
  AssembledFrame& frame = pending != nullptr ? *pending->frame : open(key, fragment, time);
  add(frame, fragment, time);
  if (is_complete(frame)) {
    const auto position = pending != nullptr ? static_cast<std::size_t>(pending - pending_.data())
                                             : pending_.size() - 1;
    close(position);
  }
  return Outcome::kAccepted;
}

unsigned FrameAssembler::required_slots(const AssembledFrame& frame, unsigned learned) const {
  if (frame.header.expected_slots != 0) {
    return frame.header.expected_slots;
  }
  // Every expected core must contain each stream observed so far.
  unsigned streams = 0;
  for (std::size_t rx_chain = 0; rx_chain < kMaxRxChains; ++rx_chain) {
    streams |= ((learned | frame.slots) >> slot_of(rx_chain, 0)) & ((1U << kMaxStreams) - 1U);
  }
  unsigned required = learned;
  for (const std::uint8_t rx_chain : options_.expected_rx_chains) {
    required |= streams << slot_of(rx_chain, 0);
  }
  return required;
}

bool FrameAssembler::is_complete(const AssembledFrame& frame) {
  unsigned learned = 0;
  if (frame.header.expected_slots == 0) {
    const std::optional<std::uint16_t> slots = traffic_.expected_slots(frame.header);
    if (!slots) {
      return false;  // warm-up of the class: the time-out decides
    }
    learned = *slots;
  }
  return (required_slots(frame, learned) & ~unsigned{frame.slots}) == 0 && frame.is_rectangular();
}

void FrameAssembler::close(std::size_t position) {
  Pending closed = std::move(pending_[position]);
  pending_.erase(pending_.begin() + static_cast<std::ptrdiff_t>(position));
  AssembledFrame& frame = *closed.frame;
  traffic_.frame_closed(frame.header, frame.slots);
  const unsigned required = required_slots(frame, traffic_.slots_so_far(frame.header));
  frame.missing_slots = static_cast<std::uint16_t>(required & ~unsigned{frame.slots});
  frame.complete = frame.missing_slots == 0 && frame.is_rectangular();
  remember(closed.key, frame);
  datagrams_in_flight_ -= frame.datagrams;
  ready_.push_back(std::move(closed.frame));
}

void FrameAssembler::remember(const Key& key, const AssembledFrame& frame) {
  const Emitted emitted{frame.time, frame.coverage, frame.digests};
  if (emitted_.size() < kRemembered) {
    emitted_.push_back(emitted);
    emitted_keys_.push_back(key);
    return;
  }
  emitted_[next_emitted_] = emitted;
  emitted_keys_[next_emitted_] = key;
  next_emitted_ = (next_emitted_ + 1) % kRemembered;
}

void FrameAssembler::advance(Timestamp now) {
  close_if([&](const AssembledFrame& frame) {
    return now > frame.time && now - frame.time > options_.timeout;
  });
}

void FrameAssembler::went_back_to(Timestamp time) {
  close_if([&](const AssembledFrame& frame) {
    return frame.time > time && frame.time - time > kLateWindow;
  });
}

template <typename Condition>
void FrameAssembler::close_if(Condition condition) {
  for (std::size_t i = 0; i < pending_.size();) {
    if (condition(*pending_[i].frame)) {
      close(i);
    } else {
      ++i;
    }
  }
}

void FrameAssembler::flush() {
  while (!pending_.empty()) {
    close(0);
  }
  // The input has ended: when a recording is played again, its fragments are no repetitions.
  emitted_.clear();
  emitted_keys_.clear();
  next_emitted_ = 0;
}

const AssembledFrame* FrameAssembler::next_ready() {
  if (next_ready_ > 0) {
    spare_.push_back(std::move(ready_[next_ready_ - 1]));
  }
  if (next_ready_ == ready_.size()) {
    ready_.clear();
    next_ready_ = 0;
    return nullptr;
  }
  return ready_[next_ready_++].get();
}

Timestamp FrameAssembler::earliest(Timestamp otherwise) const {
  for (const Pending& pending : pending_) {
    otherwise = std::min(otherwise, pending.frame->time);
  }
  for (std::size_t i = next_ready_; i < ready_.size(); ++i) {
    otherwise = std::min(otherwise, ready_[i]->time);
  }
  return otherwise;
}

}  // namespace rayloc
