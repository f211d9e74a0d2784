#include "capture/pcap_source.h"

#include <algorithm>

#include "capture/pcap_input.h"
#include "capture/pcap_parser.h"
#include "capture/recording_gap.h"

namespace rayloc {
namespace {

// Enough to make the cost of a call vanish, few enough to keep a reader's queue short.
constexpr std::size_t kBatchDatagrams = 256;

}  // namespace

Expected<std::unique_ptr<PcapFileSource>> PcapFileSource::open(const std::string& path,
                                                               const PcapFileOptions& options) {
  auto input = pcap::PcapInput::open(path);
  if (!input) {
    return tl::make_unexpected(std::move(input.error()));
  }
  return std::unique_ptr<PcapFileSource>(new PcapFileSource(std::move(*input), options));
}

PcapFileSource::PcapFileSource(std::unique_ptr<pcap::PcapInput> input,
                               const PcapFileOptions& options)
    : options_(options), input_(std::move(input)), parser_(std::make_unique<pcap::PcapParser>()) {}

PcapFileSource::~PcapFileSource() = default;

Expected<void> PcapFileSource::read(DatagramBatch& batch, Duration timeout) {
  batch.datagrams.clear();
  const std::uint64_t received_before = counting_.received;
  // Filling moves the window, and the datagrams of a batch point into it: once there is one, what
  // else is to come waits for the next call.
  take_records(batch);
  while (counting_.received == received_before && !error_ && !ended_) {
    const auto more = input_->fill(timeout);
    if (!more) {
      error_ = more.error();
    } else if (*more == pcap::PcapInput::Fill::kTimeout) {
      break;
    } else if (*more == pcap::PcapInput::Fill::kEnd) {
      end();
    } else {
      take_records(batch);
    }
  }
  batch.watermark = watermark();
  batch.ended = ended_;
  {
    const std::lock_guard lock(mutex_);
    published_ = counting_;
  }
  if (error_ && batch.datagrams.empty()) {
    return tl::make_unexpected(*error_);
  }
  return {};
}

void PcapFileSource::take_records(DatagramBatch& batch) {
  while (batch.datagrams.size() < kBatchDatagrams && !error_) {
    const pcap::PcapParser::Step step = parser_->next(input_->window());
    switch (step.status) {
      case pcap::PcapParser::Status::kNeedMore:
        return;
      case pcap::PcapParser::Status::kError:
        error_ = Error{ErrorKind::kBadInput, place() + step.error};
        return;
      case pcap::PcapParser::Status::kPacket:
        take_packet(step.packet, batch);
        break;
      case pcap::PcapParser::Status::kOther:
        break;
    }
    input_->consume(step.size);
  }
}

void PcapFileSource::take_packet(const pcap::Packet& packet, DatagramBatch& batch) {
  ++counting_.received;
  const auto datagram = pcap::udp_datagram(packet, options_.port);
  if (const auto gap = datagram ? recording_gap(*datagram) : std::nullopt) {
    ++counting_.rejected["gap_mark"];
    counting_.unrecorded += gap->datagrams.value_or(0);
    return;
  }
  const char* const reason = !datagram                      ? datagram.error()
                             : datagram->time < watermark() ? "time_went_back"
                                                            : nullptr;
  if (reason != nullptr) {
    ++counting_.rejected[reason];
    return;
  }
  ++counting_.delivered;
  counting_.bytes += datagram->payload.size();
  latest_ = std::max(latest_, datagram->time);
  batch.datagrams.push_back(*datagram);
}

void PcapFileSource::end() {
  ended_ = true;
  const std::size_t left = input_->window().size();
  if (!parser_->recognised()) {
    error_ = Error{
        ErrorKind::kBadInput,
        place() +
            (left == 0 ? "the file is empty" : "the file ends before it is known to be a capture") +
            "; write one with tcpdump -w or rayloc record"};
    return;
  }
  if (left == 0 && !input_->ends_within_gzip()) {
    return;
  }
  const std::string torn = place() + "the last record is torn: " + std::to_string(left) +
                           " bytes of it are there; everything before it was read";
  if (counting_.received == 0) {
    error_ = Error{ErrorKind::kBadInput,
                   place() + "the file ends inside its first record: nothing can be read"};
    return;
  }
  ++counting_.received;
  ++counting_.rejected["torn_record"];
  const std::lock_guard lock(mutex_);
  warning_ = torn;
}

Timestamp PcapFileSource::watermark() const {
  if (ended_) {
    return Timestamp::max();
  }
  const bool bounded = latest_.time_since_epoch() >= Duration::min() + options_.max_disorder;
  return bounded ? latest_ - options_.max_disorder : Timestamp::min();
}

SourceCounters PcapFileSource::counters() const {
  const std::lock_guard lock(mutex_);
  return published_;
}

std::string PcapFileSource::warning() const {
  const std::lock_guard lock(mutex_);
  return warning_;
}

std::string PcapFileSource::description() const { return input_->name(); }

std::string PcapFileSource::place() const {
  return input_->name() + ": byte " + std::to_string(input_->offset()) + ": ";
}

}  // namespace rayloc
