// PcapFileSource: the UDP datagrams of a capture file, or of a capture that streams in through a
// pipe.
//
// Time order. Records of a file are nearly in order of time: several receive queues or interfaces
// interleave them a little differently. The watermark therefore stays `max_disorder` behind the
// latest time seen. What is older still (the clock was set back while recording) cannot be merged
// by time any more and is rejected as "time_went_back"; a reader that only lists datagrams sets
// max_disorder to kAnyDisorder and gets them all, with a watermark that stands still to the end.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "capture/datagram_source.h"

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

  // What was torn, where, once read() has come to it; empty otherwise.
  std::string warning() const;

 private:
  PcapFileSource(std::unique_ptr<pcap::PcapInput> input, const PcapFileOptions& options);

  void take_records(DatagramBatch& batch);
  void take_packet(const pcap::Packet& packet, DatagramBatch& batch);
  void end();
  Timestamp watermark() const;
  std::string place() const;

  const PcapFileOptions options_;
  std::unique_ptr<pcap::PcapInput> input_;
  std::unique_ptr<pcap::PcapParser> parser_;
  Timestamp latest_ = Timestamp::min();
  std::optional<Error> error_;  // found behind datagrams that had to be delivered first
  bool ended_ = false;
  SourceCounters counting_;  // the reader's own

  mutable std::mutex mutex_;
  SourceCounters published_;
  std::string warning_;
};

}  // namespace rayloc
