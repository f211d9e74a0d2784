// RelaySender: sends the datagrams read from a source to the UnixSource of another process.
//
// While the other end accepts no datagrams, it waits at most 100 ms; datagrams not accepted by
// then, and those sent while the other end is absent, are lost and counted. The other end counts
// the same number as gaps in the sequence. Thread safety: none, one thread owns it.
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

  // Sends the datagrams of a batch, in order; an empty one as a tick, which carries the watermark
  // and the losses so far. Never an Error.
  Expected<void> write(const DatagramBatch& batch) override;
  void note_source(const SourceCounters& source) override;

  // Losses are "not_taken", not accepted in time by the other end, and "not_there", sent without a
  // receiver.
  const SinkCounters& counters() const override { return counters_; }
  std::string description() const override { return "unix socket " + path_; }
  // Returns true if the last write() found the other end.
  bool connected() const { return fd_ >= 0; }

 private:
  explicit RelaySender(std::string path);
  bool connect();
  void disconnect();
  void lose(bool tick, const char* reason);
  void send_one(RelayHeader& header, std::span<const std::byte> payload);

  std::string path_;
  int fd_ = -1;
  bool stalled_ = false;  // the last one was not accepted: no further wait until one is
  std::uint64_t epoch_;
  std::uint64_t sequence_ = 0;
  Timestamp watermark_{};
  std::uint64_t kernel_drops_ = 0;  // drops that the source reported
  std::uint64_t rejected_ = 0;
  SinkCounters counters_;
};

}  // namespace rayloc
