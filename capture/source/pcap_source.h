// PcapFileSource: the UDP datagrams of a capture file, or of a capture that streams in through a
// pipe.
//
// Time order. Records of a file are nearly in order of time: several receive queues or interfaces
// interleave them a little differently. The watermark therefore stays `max_disorder` behind the
// latest time seen. Which stamps are believed, and what becomes of a clock that was set, says
// record_times.h; damaged ones are rejected as "damaged_time" where they lie ahead of their
// neighbours and as "time_went_back" where they lie behind. A reader that only lists what there is
// sets max_disorder to kAnyDisorder and gets every stamp as it is, with a watermark that stands
// still to the end.
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
  // Only datagrams to this UDP port. All by default: the firmware's 5500 can be changed by a
  // relay, and the decoders refuse, with a reason, what is no CSI.
  std::optional<std::uint16_t> port;
  Duration max_disorder = std::chrono::milliseconds(100);
  Duration max_gap = kMaxGap;  // StampLimits::gap
  bool as_stamped = false;     // StampJudge's
  // What a look through the file has found; a file that is opened without it is looked through.
  std::optional<RecordTimes> times = {};
};

// Reads pcap and pcapng, gzip'd or not. A record that was cut off at the end of the file (a killed
// tcpdump) counts as rejected, "torn_record"; it is an Error only if nothing came before it.
class PcapFileSource final : public DatagramSource {
 public:
  // `path` "-" is standard input; its packets are given as they arrive.
  static Expected<std::unique_ptr<PcapFileSource>> open(const std::string& path,
                                                        const PcapFileOptions& options = {});
  ~PcapFileSource() override;

  // Waits up to `timeout` where a pipe has nothing yet.
  Expected<void> read(DatagramBatch& batch, Duration timeout) override;
  SourceCounters counters() const override;
  std::string description() const override;

  // What was torn or is padding, where, once read() has come to it.
  std::vector<std::string> warnings() const override;

  // Of a pipe: what its stamps have shown so far; for the thread that reads.
  RecordTimes streamed_times() const { return with_headers(streamed_); }
  // Adds what the headers of captures state and their records show, as far as it was read.
  RecordTimes with_headers(RecordTimes times) const;

  // Where the datagrams of the last batch lie in the file; for the thread that reads.
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
  std::optional<RecordClock> clock_;   // of a file that was looked through
  std::optional<StreamClock> stream_;  // of a pipe; neither: stamps are given as they are
  std::optional<Datagram> held_;       // by stream_; its payload is one of copies_
  RecordPlace held_place_;
  RecordTimes streamed_;
  std::optional<RecordPlace> first_header_;
  std::uint64_t zeros_ = 0;  // bytes of padding between and behind records
  std::uint64_t first_zero_ = 0;
  std::vector<RecordPlace> joined_;            // further headers
  std::vector<RecordPlace> unit_places_;       // of each of the parser's units
  std::deque<std::vector<std::byte>> copies_;  // of what was held, for as long as a batch shows it
  std::vector<RecordPlace> places_;
  RecordPlace place_now_;
  Timestamp latest_ = Timestamp::min();
  std::optional<Error> error_;  // found behind datagrams that had to be delivered first
  bool ended_ = false;
  SourceCounters counting_;  // the reader's own

  mutable std::mutex mutex_;
  SourceCounters published_;
  std::vector<std::string> warnings_;
};

// A pipe can be read once, and standard input is where somebody else has left it.
bool can_be_read_twice(const std::string& path);

// What a look through a file to its end finds, or as far as it can be read: why it ends early is
// told when it is read.
struct RecordingLook {
  RecordTimes times;
  SourceCounters counters;
};
Expected<RecordingLook> look_through(const std::string& path, const PcapFileOptions& options);

}  // namespace rayloc
