#include "capture/assemble/csi_receiver.h"

#include <algorithm>
#include <array>
#include <utility>

#include "capture/assemble/frame_assembler.h"
#include "capture/assemble/frame_normalizer.h"
#include "capture/decode/decoder_registry.h"

namespace rayloc {

class CsiReceiver::Impl {
 public:
  Impl(CsiReceiverOptions options, std::span<const DecoderRow> formats)
      : access_point_(options.access_point),
        expected_cores_(options.expected_cores),
        registry_(options.format, formats),
        assembler_(
            {std::move(options.expected_cores), options.assembly_timeout, options.max_pending}),
        normalizer_(options.access_point, options.raw) {}

  void push(const Datagram& datagram, std::vector<CsiFrame>& out) {
    // First what this datagram's time ends, then the datagram: frames of earlier times come first.
    assembler_.went_back_to(datagram.time);
    advance(datagram.time, out);
    ++counters_.received;
    if (const FrameDecoder* whole = registry_.frame_decoder(datagram.payload)) {
      push_frame(whole->decode(datagram.payload), datagram.time, out);
      return;
    }
    const DecodeResult fragment = registry_.decode(datagram.payload);
    if (!fragment) {
      reject(fragment.error());
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
    assembler_.advance(now);
    emit(out);
  }

  void flush(std::vector<CsiFrame>& out) {
    assembler_.flush();
    emit(out);
  }

  Timestamp safe_time(Timestamp watermark) const { return assembler_.earliest(watermark); }

  CsiReceiverCounters counters() const {
    CsiReceiverCounters counters = counters_;
    counters.in_flight = assembler_.datagrams_in_flight();
    for (std::size_t i = 0; i < rejected_.size(); ++i) {
      if (rejected_[i] != 0) {
        counters.rejected.emplace(to_string(static_cast<RejectReason>(i)), rejected_[i]);
      }
    }
    return counters;
  }

 private:
  // What one datagram carried whole.
  void push_frame(FrameResult frame, Timestamp time, std::vector<CsiFrame>& out) {
    if (!frame) {
      reject(frame.error());
      return;
    }
    frame->time = frame->time_last = time;
    frame->access_point = access_point_;
    const bool all_cores =
        std::all_of(expected_cores_.begin(), expected_cores_.end(), [&](std::uint8_t core) {
          return std::find(frame->cores.begin(), frame->cores.end(), core) != frame->cores.end();
        });
    if (!all_cores) {
      frame->complete = false;
      frame->flags.push_back("missing_core");
    }
    ++counters_.in_frames;
    ++counters_.frames;
    counters_.partial += frame->complete ? 0U : 1U;
    out.push_back(*std::move(frame));
  }

  void reject(RejectReason reason) { ++rejected_[static_cast<std::size_t>(reason)]; }

  void emit(std::vector<CsiFrame>& out) {
    while (const AssembledFrame* assembled = assembler_.next_ready()) {
      out.push_back(normalizer_.normalize(*assembled));
      counters_.in_frames += assembled->datagrams;
      ++counters_.frames;
      if (!assembled->complete) {
        ++counters_.partial;
      }
    }
  }

  const int access_point_;
  const std::vector<std::uint8_t> expected_cores_;
  DecoderRegistry registry_;
  FrameAssembler assembler_;
  FrameNormalizer normalizer_;
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
