#include "capture/assemble/csi_receiver.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "capture/assemble/chain_presence.h"
#include "capture/assemble/channel_log.h"
#include "capture/assemble/frame_assembler.h"
#include "capture/assemble/frame_normalizer.h"
#include "capture/assemble/held_frames.h"
#include "capture/assemble/mixture_detector.h"
#include "capture/decode/decoder_registry.h"

namespace rayloc {

class CsiReceiver::Impl {
 public:
  Impl(CsiReceiverOptions options, std::span<const DecoderRow> formats)
      : access_point_(options.access_point),
        only_devices_(options.only_devices),
        stated_(std::move(options.stated_transmitters)),
        expected_rx_chains_(options.expected_rx_chains),
        presence_(options.expected_rx_chains),
        registry_(options.format, formats),
        assembler_(
            {std::move(options.expected_rx_chains), options.assembly_timeout, options.max_pending}),
        normalizer_(options.access_point, options.raw),
        channels_(options.channel, options.accepts_hops),
        reject_mixture_(options.reject_mixture),
        held_(options.reject_mixture ? options.settle : Duration::zero()) {}

  void push(const Datagram& datagram, std::vector<CsiFrame>& out) {
    // Frames that this datagram's time ends are emitted before the datagram is added.
    assembler_.went_back_to(datagram.time);
    advance(datagram.time, out);
    ++counters_.received;
    if (const FrameDecoder* whole = registry_.frame_decoder(datagram.payload)) {
      push_frame(whole->decode(datagram.payload), datagram, out);
      return;
    }
    const DecodeResult fragment = registry_.decode(datagram.payload);
    if (!fragment) {
      reject(fragment.error());
      return;
    }
    if (const auto reason = no_device(fragment->transmitter)) {
      reject(*reason);
      return;
    }
    const bool is_expected_channel = channels_.add(fragment->channel, datagram.time);
    if (is_expected_channel) {
      mixture_.add(*fragment, datagram.address, datagram.time);
    }
    if (!admit(is_expected_channel)) {
      return;
    }
    switch (assembler_.push(*fragment, datagram.time)) {
      case FrameAssembler::Outcome::kAccepted:
        break;
      case FrameAssembler::Outcome::kDuplicate:
        ++counters_.duplicates;
        break;
      case FrameAssembler::Outcome::kLate:
        ++counters_.late;
        break;
      case FrameAssembler::Outcome::kMismatch:
        reject(RejectReason::kFrameMismatch);
        break;
    }
    emit(out);
  }

  void advance(Timestamp now, std::vector<CsiFrame>& out) {
    now_ = now;
    for (HeldFrames::Held& held : held_.release(now)) {
      give(std::move(held.frame), held.datagrams, out);
    }
    assembler_.advance(now);
    emit(out);
  }

  void flush(std::vector<CsiFrame>& out) {
    assembler_.flush();
    emit(out);
    for (HeldFrames::Held& held : held_.release_all()) {
      give(std::move(held.frame), held.datagrams, out);
    }
    mixture_.reset();
  }

  Timestamp safe_time(Timestamp watermark) const {
    return held_.earliest(assembler_.earliest(watermark));
  }

  CsiReceiverCounters counters() const {
    CsiReceiverCounters counters = counters_;
    counters.in_flight = assembler_.datagrams_in_flight() + held_.datagrams();
    channels_.report(counters);
    counters.trouble = trouble_;
    counters.troubles = troubles_;
    for (std::size_t i = 0; i < rejected_.size(); ++i) {
      if (rejected_[i] != 0) {
        counters.rejected.emplace(to_string(static_cast<RejectReason>(i)), rejected_[i]);
      }
    }
    return counters;
  }

 private:
  std::optional<RejectReason> no_device(const MacAddress& transmitter) const {
    if (!only_devices_ || std::find(stated_.begin(), stated_.end(), transmitter) != stated_.end()) {
      return std::nullopt;
    }
    if ((transmitter.octets[0] & 1U) != 0) {
      return RejectReason::kGroupAddress;
    }
    return transmitter == MacAddress() ? std::optional(RejectReason::kZeroAddress) : std::nullopt;
  }

  // Evaluates the source after one of its datagrams; counts the datagram if it is rejected.
  bool admit(bool is_expected_channel) {
    held_.hold_from(mixture_.newest_beginning());
    const bool is_mixture = reject_mixture_ && mixture_.is_mixture();
    if (is_mixture) {
      for (const HeldFrames::Held& held : held_.release_all()) {
        reject(RejectReason::kSeveralAccessPoints, held.datagrams);
      }
    }
    update_trouble();
    if (is_expected_channel && !is_mixture) {
      return true;
    }
    reject(is_expected_channel ? RejectReason::kSeveralAccessPoints : RejectReason::kOtherChannel);
    return false;
  }

  void update_trouble() {
    const auto state = std::pair(channels_.changes(), mixture_.evidence());
    if (state == judged_) {
      return;
    }
    judged_ = state;
    trouble_ = channels_.trouble();
    if (trouble_.empty() && reject_mixture_ && mixture_.is_mixture()) {
      trouble_ = "it has datagrams of several access points: " +
                 std::string(to_string(mixture_.evidence()));
    }
    if (!trouble_.empty() && troubles_.size() < CsiReceiverCounters::kListedChanges &&
        std::find(troubles_.begin(), troubles_.end(), trouble_) == troubles_.end()) {
      troubles_.push_back(trouble_);
    }
  }

  // Handles one datagram with a whole frame.
  void push_frame(FrameResult frame, const Datagram& datagram, std::vector<CsiFrame>& out) {
    if (!frame) {
      reject(frame.error());
      return;
    }
    const bool is_expected_channel = channels_.add(frame->channel, datagram.time);
    if (is_expected_channel) {
      mixture_.add(datagram.address, datagram.time);
    }
    if (!admit(is_expected_channel)) {
      return;
    }
    // The short records of an Intel 5300 contain no address.
    if (const auto reason = no_device(frame->transmitter); reason == RejectReason::kGroupAddress) {
      reject(*reason);
      return;
    }
    frame->time = frame->time_last = datagram.time;
    frame->access_point = access_point_;
    const bool all_rx_chains = std::all_of(
        expected_rx_chains_.begin(), expected_rx_chains_.end(), [&](std::uint8_t rx_chain) {
          return std::find(frame->rx_chains.begin(), frame->rx_chains.end(), rx_chain) !=
                 frame->rx_chains.end();
        });
    if (!all_rx_chains) {
      frame->complete = false;
      frame->flags.emplace_back("missing_core");
    }
    finish(*std::move(frame), 1, out);
  }

  void reject(RejectReason reason, std::uint64_t datagrams = 1) {
    rejected_[static_cast<std::size_t>(reason)] += datagrams;
  }

  void emit(std::vector<CsiFrame>& out) {
    while (const AssembledFrame* assembled = assembler_.next_ready()) {
      finish(normalizer_.normalize(*assembled), assembled->datagrams, out);
    }
  }

  void finish(CsiFrame&& frame, std::uint64_t datagrams, std::vector<CsiFrame>& out) {
    if (reject_mixture_ && mixture_.is_mixture()) {
      reject(RejectReason::kSeveralAccessPoints, datagrams);
      return;
    }
    if (!held_.holds(now_)) {
      give(std::move(frame), datagrams, out);
      return;
    }
    held_.add({std::move(frame), datagrams});
    if (held_.is_full()) {
      HeldFrames::Held oldest = held_.release_oldest();
      give(std::move(oldest.frame), oldest.datagrams, out);
    }
  }

  void give(CsiFrame&& frame, std::uint64_t datagrams, std::vector<CsiFrame>& out) {
    counters_.in_frames += datagrams;
    ++counters_.frames;
    counters_.partial += frame.complete ? 0U : 1U;
    presence_.mark(frame, counters_.without_rx_chain);
    out.push_back(std::move(frame));
  }

  const std::size_t access_point_;
  const bool only_devices_;
  const std::vector<MacAddress> stated_;
  const std::vector<std::uint8_t> expected_rx_chains_;
  ChainPresence presence_;
  DecoderRegistry registry_;
  FrameAssembler assembler_;
  FrameNormalizer normalizer_;
  ChannelLog channels_;
  const bool reject_mixture_;
  MixtureDetector mixture_;
  HeldFrames held_;
  Timestamp now_ = Timestamp::min();
  // Values at the last update_trouble().
  std::pair<std::uint64_t, MixtureDetector::Evidence> judged_{};
  std::string trouble_;
  std::vector<std::string> troubles_;
  CsiReceiverCounters counters_;  // `rejected` and `in_flight` are filled in by counters()
  std::array<std::uint64_t, kRejectReasons> rejected_{};
};

CsiReceiver::CsiReceiver(CsiReceiverOptions options)
    : CsiReceiver(std::move(options), decoder_rows()) {}
CsiReceiver::CsiReceiver(CsiReceiverOptions options, std::span<const DecoderRow> formats)
    : impl_(std::make_unique<Impl>(std::move(options), formats)) {}
CsiReceiver::~CsiReceiver() = default;
CsiReceiver::CsiReceiver(CsiReceiver&&) noexcept = default;
CsiReceiver& CsiReceiver::operator=(CsiReceiver&&) noexcept = default;

void CsiReceiver::push(const Datagram& datagram, std::vector<CsiFrame>& out) {
  impl_->push(datagram, out);
}
void CsiReceiver::advance(Timestamp watermark, std::vector<CsiFrame>& out) {
  impl_->advance(watermark, out);
}
void CsiReceiver::flush(std::vector<CsiFrame>& out) { impl_->flush(out); }
Timestamp CsiReceiver::safe_time(Timestamp watermark) const { return impl_->safe_time(watermark); }
CsiReceiverCounters CsiReceiver::counters() const { return impl_->counters(); }

}  // namespace rayloc
