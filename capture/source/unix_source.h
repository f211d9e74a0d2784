// UnixSource: the datagrams relayed by rayloc-capture (relayed_datagram.h), received at an AF_UNIX
// datagram socket. A daemon without any privilege thus receives an interface's traffic.
//
// Only senders of our own user and root are accepted; datagrams of others are rejected as
// "stranger". Datagrams that are missing in the sender's sequence, and those its kernel dropped,
// count as kernel_drops; packets in which it found no datagram as rejected by "rayloc_capture".
// Time: the sender's. Without a sender the watermark follows our clock a second behind. Thread
// safety: one thread reads; counters() from any.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "capture/transport/datagram_source.h"

namespace rayloc {

struct UnixSourceOptions {
  std::string path = {};  // "/run/raylocd/eth7"; a socket that a killed process left is replaced
  int adopted_fd = -1;    // an AF_UNIX datagram socket to adopt instead (socket activation)
};

class UnixSource final : public DatagramSource {
 public:
  // kUnavailable if the path is in use or cannot be created, kUsage if it is too long.
  static Expected<std::unique_ptr<UnixSource>> open(const UnixSourceOptions& options);
  ~UnixSource() override;

  Expected<void> read(DatagramBatch& batch, Duration timeout) override;
  SourceCounters counters() const override;
  std::string description() const override;
  std::optional<int> poll_descriptor() const override;

 private:
  class Impl;
  explicit UnixSource(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rayloc
