#include "capture/source/pcap_source.h"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "capture/record/pcap_parser.h"
#include "capture/record/recording_gap.h"
#include "capture/source/pcap_input.h"

namespace rayloc {
namespace {

// Large enough to amortise the cost of a call, small enough to keep a reader's queue short.
constexpr std::size_t kFileBatchDatagrams = 256;

// Maximum number of anomalies in a pipe that are reported at its end.
constexpr std::size_t kMaxNoted = 1000;

// Padding of files to whole blocks: no record of any format begins with so many zeros.
constexpr std::size_t kPaddingZeros = 16;

// Compares the available bytes only.
bool begins_with_zeros(std::span<const std::byte> bytes) {
  const std::span<const std::byte> first = bytes.first(std::min(bytes.size(), kPaddingZeros));
  return std::all_of(first.begin(), first.end(), [](std::byte b) { return b == std::byte{0}; });
}

std::vector<pcap::TimeUnit> shown_units(const std::optional<RecordTimes>& times) {
  std::vector<pcap::TimeUnit> shown;
  for (const CaptureUnit& capture : times ? times->units : std::vector<CaptureUnit>()) {
    shown.push_back(capture.shown);
  }
  return shown;
}

}  // namespace

bool can_be_read_twice(const std::string& path) {
  std::error_code unknown;
  return path != "-" && std::filesystem::is_regular_file(path, unknown);
}

Expected<std::unique_ptr<PcapFileSource>> PcapFileSource::open(const std::string& path,
                                                               const PcapFileOptions& options) {
  auto input = pcap::PcapInput::open(path);
  RAYLOC_TRY(input);
  PcapFileOptions known = options;
  if (options.max_disorder != kAnyDisorder && !options.times && can_be_read_twice(path)) {
    auto scan = scan_recording(path, options);
    RAYLOC_TRY(scan);
    known.times = std::move(scan->times);
  }
  return std::unique_ptr<PcapFileSource>(new PcapFileSource(std::move(*input), known));
}

PcapFileSource::PcapFileSource(std::unique_ptr<pcap::PcapInput> input,
                               const PcapFileOptions& options)
    : options_(options),
      input_(std::move(input)),
      parser_(std::make_unique<pcap::PcapParser>(shown_units(options.times))) {
  if (options.max_disorder == kAnyDisorder) {
    return;
  }
  if (options.times) {
    clock_.emplace(*options.times);
  } else {
    streamed_.streamed = true;
    stream_.emplace(StampLimits{options.max_disorder, options.max_gap}, options.as_stamped);
  }
}

PcapFileSource::~PcapFileSource() = default;

Expected<void> PcapFileSource::read(DatagramBatch& batch, Duration timeout) {
  batch.datagrams.clear();
  places_.clear();
  while (copies_.size() > (held_ ? 1U : 0U)) {
    copies_.pop_front();
  }
  const std::uint64_t received_before = counting_.received;
  // Filling moves the window, and the datagrams of a batch refer to it: once the batch is not
  // empty, further input waits for the next call.
  take_records(batch);
  while (counting_.received == received_before && !error_ && !ended_) {
    const auto more = input_->fill(timeout);
    if (!more) {
      error_ = more.error();
    } else if (*more == pcap::PcapInput::Fill::kTimeout) {
      break;
    } else if (*more == pcap::PcapInput::Fill::kEnd) {
      end(batch);
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
  while (batch.datagrams.size() < kFileBatchDatagrams && !error_) {
    if (skip_zeros()) {
      continue;
    }
    if (parser_->recognised() && input_->window().size() < kPaddingZeros &&
        begins_with_zeros(input_->window())) {
      return;  // more bytes determine if it is padding
    }
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
        if (step.begins_capture) {
          note_header();
        }
        break;
    }
    input_->consume(step.size);
  }
}

bool PcapFileSource::skip_zeros() {
  if (!parser_->recognised() || input_->window().size() < kPaddingZeros ||
      !begins_with_zeros(input_->window())) {
    return false;
  }
  add_zeros(kPaddingZeros);
  return true;
}

void PcapFileSource::add_zeros(std::size_t bytes) {
  first_zero_ = zeros_ == 0 ? input_->offset() : first_zero_;
  zeros_ += bytes;
  input_->consume(bytes);
}

void PcapFileSource::note_padding() {
  const pcap::PcapInput::Padding packed = input_->padding();
  const std::lock_guard lock(mutex_);
  if (packed.bytes > 0) {
    warnings_.push_back(input_->name() + ": byte " + std::to_string(packed.offset) +
                        " of the gzip'd file: " + std::to_string(packed.bytes) +
                        " bytes of padding are no gzip data and were left out");
  }
  if (zeros_ > 0) {
    warnings_.push_back(input_->name() + ": byte " + std::to_string(first_zero_) + ": " +
                        std::to_string(zeros_) + " zero bytes are padding and were left out");
  }
}

void PcapFileSource::note_header() {
  const RecordPlace place{counting_.received + 1, input_->offset()};
  if (first_header_) {
    joined_.push_back(place);
  }
  first_header_ = first_header_.value_or(place);
  if (parser_->units().size() > unit_places_.size()) {
    unit_places_.push_back(place);
  }
}

void PcapFileSource::take_packet(const pcap::Packet& packet, DatagramBatch& batch) {
  ++counting_.received;
  place_now_ = {counting_.received, input_->offset()};
  const char* through = nullptr;
  const auto datagram = pcap::udp_datagram(packet, options_.port, &through);
  if (!datagram) {
    reject_packet(packet, datagram.error());
    return;
  }
  if (const auto gap = recording_gap(*datagram)) {
    ++counting_.rejected["gap_mark"];
    counting_.unrecorded += gap->datagrams.value_or(0);
    return;
  }
  if (through != nullptr) {
    ++counting_.unwrapped[through];
  }
  take_datagram(*datagram, batch);
}

void PcapFileSource::reject_packet(const pcap::Packet& packet, const std::string& reason) {
  ++counting_.rejected[reason];
  if (reason == "truncated_capture" && packet.original_length > counting_.cut_original) {
    counting_.cut_captured = static_cast<std::uint32_t>(packet.data.size());
    counting_.cut_original = packet.original_length;
  }
}

void PcapFileSource::take_datagram(const Datagram& datagram, DatagramBatch& batch) {
  if (stream_) {
    take_streamed(datagram, batch);
    return;
  }
  const auto time =
      clock_ ? clock_->event_time(place_now_.packet, datagram.time) : std::optional(datagram.time);
  if (time) {
    give(datagram, *time, batch);
  } else {
    reject_damaged(clock_->is_late());
  }
}

void PcapFileSource::take_streamed(const Datagram& datagram, DatagramBatch& batch) {
  using Ruling = StreamClock::Ruling;
  const Timestamp latest = stream_->latest();
  Ruling ruling = stream_->scan(datagram.time);
  if (ruling == Ruling::kGiveHeld) {
    if (streamed_.jumps.size() < kMaxNoted) {
      streamed_.jumps.push_back(
          {held_place_, latest, held_->time, Duration::zero(), stream_->is_late()});
    }
    const RecordPlace place = std::exchange(place_now_, held_place_);
    const Datagram held = *std::exchange(held_, std::nullopt);
    give(held, stream_->event_time(held.time), batch);
    place_now_ = place;
    ruling = stream_->scan(datagram.time);
  }
  if (ruling == Ruling::kHold) {
    hold(datagram);
    return;
  }
  if (ruling == Ruling::kDropHeld) {
    reject_held();
  }
  give(datagram, stream_->event_time(datagram.time), batch);
}

void PcapFileSource::hold(const Datagram& datagram) {
  copies_.emplace_back(datagram.payload.begin(), datagram.payload.end());
  held_ = datagram;
  held_->payload = copies_.back();
  held_place_ = place_now_;
}

void PcapFileSource::reject_held() {
  const Datagram held = *std::exchange(held_, std::nullopt);
  if (streamed_.damaged.size() < kMaxNoted) {
    streamed_.damaged.push_back(
        {held_place_, held_place_.packet, 1, held.time - stream_->latest()});
  }
  reject_damaged(stream_->is_late());
}

void PcapFileSource::reject_damaged(bool late) {
  ++counting_.rejected[late ? "time_went_back" : "damaged_time"];
}

void PcapFileSource::give(Datagram datagram, Timestamp time, DatagramBatch& batch) {
  datagram.time = time;
  if (time < watermark() && !options_.as_stamped) {  // after the part that was scanned
    reject_damaged(true);
    return;
  }
  ++counting_.delivered;
  counting_.bytes += datagram.payload.size();
  latest_ = std::max(latest_, time);
  batch.datagrams.push_back(datagram);
  places_.push_back(place_now_);
}

void PcapFileSource::end(DatagramBatch& batch) {
  if (held_ && stream_->give_at_end()) {
    const Datagram held = *std::exchange(held_, std::nullopt);
    place_now_ = held_place_;
    give(held, stream_->event_time(held.time), batch);
  } else if (held_) {
    reject_held();
  }
  ended_ = true;
  if (zeros_ > 0 && begins_with_zeros(input_->window())) {
    add_zeros(input_->window().size());
  }
  note_padding();
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
  warnings_.push_back(torn);
}

Timestamp PcapFileSource::watermark() const {
  if (ended_) {
    return Timestamp::max();
  }
  if (options_.as_stamped) {
    return Timestamp::min();
  }
  const bool bounded = latest_.time_since_epoch() >= Duration::min() + options_.max_disorder;
  return bounded ? latest_ - options_.max_disorder : Timestamp::min();
}

SourceCounters PcapFileSource::counters() const {
  const std::lock_guard lock(mutex_);
  return published_;
}

std::vector<std::string> PcapFileSource::warnings() const {
  const std::lock_guard lock(mutex_);
  return warnings_;
}

std::string PcapFileSource::description() const { return input_->name(); }

std::string PcapFileSource::place() const {
  return input_->name() + ": byte " + std::to_string(input_->offset()) + ": ";
}

RecordTimes PcapFileSource::with_headers(RecordTimes times) const {
  times.units.clear();
  for (std::size_t i = 0; i < unit_places_.size(); ++i) {
    const pcap::SubsecondUnit& unit = parser_->units()[i];
    times.units.push_back({unit_places_[i], unit.stated(), unit.shown(), unit.misread()});
  }
  times.misstated = parser_->misstated();
  times.joined = joined_;
  times.of_counter = parser_->has_counter_stamps();
  return times;
}

namespace {

Expected<RecordingScan> scan_once(const std::string& path,
                                  const PcapFileOptions& options,
                                  const std::optional<RecordTimes>& units) {
  PcapFileOptions everything = options;
  everything.max_disorder = kAnyDisorder;
  everything.times = units;
  auto source = PcapFileSource::open(path, everything);
  RAYLOC_TRY(source);
  StampJudge judge({options.max_disorder, options.max_gap}, options.as_stamped);
  DatagramBatch batch;
  while (!batch.ended && (*source)->read(batch, std::chrono::seconds(1))) {
    for (std::size_t i = 0; i < batch.datagrams.size(); ++i) {
      judge.add((*source)->places()[i], batch.datagrams[i].time);
    }
  }
  return RecordingScan{(*source)->with_headers(judge.finish()), (*source)->counters()};
}

}  // namespace

Expected<RecordingScan> scan_recording(const std::string& path, const PcapFileOptions& options) {
  auto scan = scan_once(path, options, std::nullopt);
  const bool misread = scan && std::any_of(scan->times.units.begin(),
                                           scan->times.units.end(),
                                           [](const CaptureUnit& unit) { return unit.misread; });
  return misread ? scan_once(path, options, scan->times) : scan;
}

}  // namespace rayloc
