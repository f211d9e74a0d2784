#include "capture/source/recorded_source.h"

#include <algorithm>
#include <utility>

#include "capture/record/pcap_recorder.h"
#include "capture/source/rejection_words.h"
#include "capture/source/transport_schemes.h"

namespace rayloc {
namespace {

constexpr std::size_t kRecordedBatchDatagrams = 256;

}  // namespace

Expected<std::unique_ptr<RecordedSource>> RecordedSource::open(RecordingPlan plan) {
  std::unique_ptr<RecordedSource> source(new RecordedSource(std::move(plan)));
  // Opened here, so that a file that cannot be opened is reported at once.
  RAYLOC_TRY(source->open_due());
  return source;
}

Expected<std::unique_ptr<RecordedSource>> RecordedSource::open(
    const std::vector<std::string>& files, const PcapFileOptions& options) {
  auto plan = plan_recording(files, options);
  RAYLOC_TRY(plan);
  return open(*std::move(plan));
}

// Opens the files that begin before any datagram that waits to be returned.
Expected<void> RecordedSource::open_due() {
  while (next_file_ < plan_.files.size()) {
    Timestamp earliest = Timestamp::max();
    for (const Reader& reader : readers_) {
      earliest = std::min(earliest, reader.has_next() ? reader.front().time : Timestamp::max());
    }
    const PlannedFile& file = plan_.files[next_file_];
    if (!readers_.empty() && begin_of(file) > earliest) {
      return {};
    }
    const bool waits = std::any_of(readers_.begin(), readers_.end(), [](const Reader& reader) {
      return !reader.has_next() && !reader.batch.ended;
    });
    if (waits) {  // its next datagram is not available yet
      return {};
    }
    PcapFileOptions options = plan_.options;
    if (file.scan) {
      options.times = file.scan->times;
    }
    auto opened = PcapFileSource::open(file.path, options);
    RAYLOC_TRY(opened);
    readers_.push_back({std::move(*opened), file.scan.has_value(), {}, 0});
    ++next_file_;
  }
  return {};
}

// Returns false if a reader has no datagram to compare and may not be read or timed out.
Expected<bool> RecordedSource::fill(Duration timeout, bool may_read) {
  for (Reader& reader : readers_) {
    if (reader.has_next() || reader.batch.ended) {
      continue;
    }
    if (!may_read) {
      return false;
    }
    reader.next = 0;
    if (auto read = reader.source->read(reader.batch, timeout); !read) {
      reader.batch.datagrams.clear();
      return tl::make_unexpected(std::move(read.error()));
    }
    if (!reader.has_next() && !reader.batch.ended) {
      return false;
    }
  }
  return true;
}

void RecordedSource::close_ended() {
  std::erase_if(readers_, [&](const Reader& reader) {
    if (reader.has_next() || !reader.batch.ended) {
      return false;
    }
    add_counts(closed_, reader.source->counters());
    add_warnings(reader, warnings_);
    return true;
  });
}

void RecordedSource::add_warnings(const Reader& reader, std::vector<std::string>& to) const {
  const std::vector<std::string> torn = reader.source->warnings();
  to.insert(to.end(), torn.begin(), torn.end());
  if (reader.is_scanned) {  // reported by describe()
    return;
  }
  const std::vector<std::string> stamps = describe(
      reader.source->streamed_times(), reader.source->description(), least_gap(plan_.options));
  to.insert(to.end(), stamps.begin(), stamps.end());
  const std::vector<std::string> rejections =
      rejection_words(reader.source->counters(), reader.source->description());
  to.insert(to.end(), rejections.begin(), rejections.end());
}

std::vector<std::string> RecordedSource::warnings() const {
  std::vector<std::string> all = warnings_;
  for (const Reader& reader : readers_) {
    add_warnings(reader, all);
  }
  return all;
}

Expected<void> RecordedSource::read(DatagramBatch& batch, Duration timeout) {
  batch.datagrams.clear();
  while (batch.datagrams.size() < kRecordedBatchDatagrams) {
    // The datagrams of a batch refer to the readers' memory until the next call.
    const bool may_read = batch.datagrams.empty();
    if (may_read) {
      close_ended();
    }
    auto opened = open_due();
    auto filled = opened ? fill(timeout, may_read) : tl::make_unexpected(opened.error());
    if (!filled) {
      publish();
      return tl::make_unexpected(std::move(filled.error()));
    }
    if (!*filled) {
      break;
    }
    Reader* earliest = nullptr;
    for (Reader& reader : readers_) {
      if (reader.has_next() &&
          (earliest == nullptr || reader.front().time < earliest->front().time)) {
        earliest = &reader;
      }
    }
    const bool another_first = earliest != nullptr && next_file_ < plan_.files.size() &&
                               begin_of(plan_.files[next_file_]) <= earliest->front().time;
    if (earliest == nullptr &&
        (!may_read || (readers_.empty() && next_file_ == plan_.files.size()))) {
      break;
    }
    if (earliest != nullptr && !another_first) {
      batch.datagrams.push_back(earliest->front());
      ++earliest->next;
    }
  }
  if (batch.datagrams.empty()) {
    close_ended();
  }
  batch.ended =
      std::all_of(readers_.begin(),
                  readers_.end(),
                  [](const Reader& reader) { return !reader.has_next() && reader.batch.ended; }) &&
      next_file_ == plan_.files.size();
  watermark_ = std::max(watermark_, batch.ended ? Timestamp::max() : watermark());
  batch.watermark = watermark_;
  publish();
  return {};
}

Timestamp RecordedSource::watermark() const {
  Timestamp earliest = Timestamp::max();
  for (const Reader& reader : readers_) {
    earliest = std::min(earliest, reader.batch.watermark);
    for (std::size_t i = reader.next; i < reader.batch.datagrams.size(); ++i) {
      earliest = std::min(earliest, reader.batch.datagrams[i].time);
    }
  }
  if (next_file_ < plan_.files.size()) {  // the earliest of the files that are not open
    earliest = std::min(earliest, begin_of(plan_.files[next_file_]));
  }
  return earliest;
}

void RecordedSource::publish() {
  SourceCounters all = closed_;
  for (const Reader& reader : readers_) {
    add_counts(all, reader.source->counters());
  }
  const std::lock_guard lock(mutex_);
  published_ = std::move(all);
}

SourceCounters RecordedSource::counters() const {
  const std::lock_guard lock(mutex_);
  return published_;
}

const TransportScheme kPcapScheme{
    .name = "pcap",
    .address = "FILE",
    .example = "pcap:recording.pcap",
    .summary = "a recording: pcap or pcapng, gzip'd or not; written as pcap",
    .live = false,
    .open_source =
        [](const std::string& address, const SourceOptions& options) {
          PcapFileOptions recorded;
          recorded.max_gap = options.max_gap.value_or(recorded.max_gap);
          return as_transport<DatagramSource>(RecordedSource::open({address}, recorded));
        },
    .open_sink = [](const std::string& address) -> Expected<std::unique_ptr<DatagramSink>> {
      auto recorder = PcapRecorder::create(address);
      RAYLOC_TRY(recorder);
      return std::make_unique<PcapRecorder>(*std::move(recorder));
    },
};

}  // namespace rayloc
