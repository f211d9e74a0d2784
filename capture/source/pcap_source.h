// PcapFileSource: the UDP datagrams of a capture file, or of a capture that is streamed through a
// pipe.
//
// Time order: records of a file are nearly in order of time; several receive queues or interfaces
// interleave them slightly out of order. The watermark therefore remains `max_disorder` behind
// the latest time read. record_times.h defines which stamps are accepted and how clock steps are
// handled; damaged stamps are rejected as "damaged_time" if they are ahead of their neighbours
// and as "time_went_back" if they are behind. A reader that only lists the records sets
// max_disorder to kAnyDisorder and gets every stamp unchanged, with a constant watermark until
// the end.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "capture/source/record_times.h"
#include "capture/transport/datagram_source.h"

namespace rayloc {

namespace pcap {
class PcapInput;
class PcapParser;
struct Packet;
}  // namespace pcap

constexpr Duration kAnyDisorder = Duration::max();

struct PcapFileOptions {
  // Only datagrams to this UDP port. All by default: a relay can change the firmware's 5500, and
  // the decoders reject payloads that are not CSI, with a reason.
  std::optional<std::uint16_t> port;
  Duration max_disorder = std::chrono::milliseconds(100);
  Duration max_gap = kMaxGap;  // StampLimits::gap
  bool as_stamped = false;     // parameter of StampJudge
  // The result of a scan of the file; a file that is opened without it is scanned first.
  std::optional<RecordTimes> times = {};
};

// Reads pcap and pcapng, gzip'd or not. A record that is cut off at the end of the file (a killed
// tcpdump) counts as rejected, "torn_record"; it is an Error only if no record precedes it.
class PcapFileSource final : public DatagramSource {
 public:
  // `path` "-" is standard input; its packets are delivered as they arrive.
  static Expected<std::unique_ptr<PcapFileSource>> open(const std::string& path,
                                                        const PcapFileOptions& options = {});
  ~PcapFileSource() override;

  // Waits up to `timeout` if a pipe has no data yet.
  Expected<void> read(DatagramBatch& batch, Duration timeout) override;
  SourceCounters counters() const override;
  std::string description() const override;

  // Torn records and padding read so far, with their places.
  std::vector<std::string> warnings() const override;

  // For a pipe: the times that its stamps have shown so far; for the thread that reads.
  RecordTimes streamed_times() const { return with_headers(streamed_); }
  // Adds the statements of the capture headers and the units of their records, as far as read.
  RecordTimes with_headers(RecordTimes times) const;

  // The places in the file of the last batch's datagrams; for the thread that reads.
  const std::vector<RecordPlace>& places() const { return places_; }

 private:
  PcapFileSource(std::unique_ptr<pcap::PcapInput> input, const PcapFileOptions& options);

  void take_records(DatagramBatch& batch);
  bool skip_zeros();
  void add_zeros(std::size_t bytes);
  void note_header();
  void note_padding();
  void take_packet(const pcap::Packet& packet, DatagramBatch& batch);
  void reject_packet(const pcap::Packet& packet, const std::string& reason);
  void take_datagram(const Datagram& datagram, DatagramBatch& batch);
  void take_streamed(const Datagram& datagram, DatagramBatch& batch);
  void give(Datagram datagram, Timestamp time, DatagramBatch& batch);
  void hold(const Datagram& datagram);
  void reject_held();
  void reject_damaged(bool late);
  void end(DatagramBatch& batch);
  Timestamp watermark() const;
  std::string place() const;

  const PcapFileOptions options_;
  std::unique_ptr<pcap::PcapInput> input_;
  std::unique_ptr<pcap::PcapParser> parser_;
  std::optional<RecordClock> clock_;   // clock of a scanned file
  std::optional<StreamClock> stream_;  // clock of a pipe; with neither, stamps remain unchanged
  std::optional<Datagram> held_;       // held back by stream_; its payload is one of copies_
  RecordPlace held_place_;
  RecordTimes streamed_;
  std::optional<RecordPlace> first_header_;
  std::uint64_t zeros_ = 0;  // bytes of padding between and behind records
  std::uint64_t first_zero_ = 0;
  std::vector<RecordPlace> joined_;            // places of further headers
  std::vector<RecordPlace> unit_places_;       // places of the parser's units
  std::deque<std::vector<std::byte>> copies_;  // held payloads, while a batch refers to them
  std::vector<RecordPlace> places_;
  RecordPlace place_now_;
  Timestamp latest_ = Timestamp::min();
  std::optional<Error> error_;  // found after datagrams that had to be delivered first
  bool ended_ = false;
  SourceCounters counting_;  // used by the reading thread only

  mutable std::mutex mutex_;
  SourceCounters published_;
  std::vector<std::string> warnings_;
};

// A pipe can be read once, and standard input may already have been read in part.
bool can_be_read_twice(const std::string& path);

// Result of scanning a file to its end, or as far as it is readable: the reason for an early end is
// reported when the file is read.
struct RecordingScan {
  RecordTimes times;
  SourceCounters counters;
};
Expected<RecordingScan> scan_recording(const std::string& path, const PcapFileOptions& options);

}  // namespace rayloc
