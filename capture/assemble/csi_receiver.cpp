#include "capture/assemble/csi_receiver.h"

#include <array>
#include <utility>

#include "capture/assemble/frame_assembler.h"
#include "capture/assemble/frame_normalizer.h"
#include "capture/decode/decoder_registry.h"

namespace rayloc {

class CsiReceiver::Impl {
 public:
  explicit Impl(CsiReceiverOptions options)
      : registry_(options.format),
        assembler_(
            {std::move(options.expected_cores), options.assembly_timeout, options.max_pending}),
        normalizer_(options.access_point, options.raw) {}

  void push(const Datagram& datagram, std::vector<CsiFrame>& out) {
    // First what this datagram's time ends, then the datagram: frames of earlier times come first.
    assembler_.went_back_to(datagram.time);
    advance(datagram.time, out);
    ++counters_.received;
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

  DecoderRegistry registry_;
  FrameAssembler assembler_;
  FrameNormalizer normalizer_;
  CsiReceiverCounters counters_;  // `rejected` and `in_flight` are filled in by counters()
  std::array<std::uint64_t, kRejectReasons> rejected_{};
};

CsiReceiver::CsiReceiver(CsiReceiverOptions options)
    : impl_(std::make_unique<Impl>(std::move(options))) {}
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
