// RelaySender: hands what a source has read to the UnixSource of another process.
//
// While the other end does not take anything, at most 100 ms are waited for it; what it has not
// taken by then, and what comes while it is not there, is lost and counted. The other end sees the
// same number as gaps in the sequence. Thread safety: none, one thread owns it.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "capture/transport/datagram_sink.h"
#include "capture/transport/relayed_datagram.h"

namespace rayloc {

class RelaySender final : public DatagramSink {
 public:
  // `path` need not exist yet. kUsage when it is too long for a socket.
  static Expected<std::unique_ptr<RelaySender>> open(const std::string& path);
  ~RelaySender() override;
  RelaySender(const RelaySender&) = delete;
  RelaySender& operator=(const RelaySender&) = delete;

  // The datagrams of a batch, in order; an empty one as a tick, which carries the watermark and
  // what was lost so far. Never an Error.
  Expected<void> write(const DatagramBatch& batch) override;
  void note_source(const SourceCounters& source) override;

  // Lost are "not_taken", which the other end did not take in time, and "not_there", when nobody
  // was there.
  const SinkCounters& counters() const override { return counters_; }
  std::string description() const override { return "unix socket " + path_; }
  // Whether the last write() found the other end.
  bool connected() const { return fd_ >= 0; }

 private:
  explicit RelaySender(std::string path);
  bool connect();
  void disconnect();
  void lose(bool tick, const char* reason);
  void send_one(RelayHeader& header, std::span<const std::byte> payload);

  std::string path_;
  int fd_ = -1;
  bool stalled_ = false;  // the last one was not taken: no further wait until one is
  std::uint64_t epoch_;
  std::uint64_t sequence_ = 0;
  Timestamp watermark_{};
  std::uint64_t kernel_drops_ = 0;  // of the source
  std::uint64_t rejected_ = 0;
  SinkCounters counters_;
};

}  // namespace rayloc
