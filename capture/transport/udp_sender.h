// UdpSender: sends datagrams to one UDP endpoint, many by one system call.
#pragma once

#include <netinet/in.h>

#include <memory>
#include <string>

#include "capture/transport/datagram_sink.h"
#include "capture/transport/file_descriptor.h"

namespace rayloc {

class UdpSender final : public DatagramSink {
 public:
  // `address` is HOST:PORT; kUsage if it is invalid.
  static Expected<std::unique_ptr<UdpSender>> open(const std::string& address);

  // The presence of a receiver at the destination is unknown, as it is to the access point.
  Expected<void> write(const DatagramBatch& batch) override;
  const SinkCounters& counters() const override { return counters_; }
  std::string description() const override;

 private:
  UdpSender(int fd, const sockaddr_in& destination) : fd_(fd), destination_(destination) {}
  Expected<void> send(std::span<const Datagram> datagrams);

  FileDescriptor fd_;
  sockaddr_in destination_;
  SinkCounters counters_;
};

}  // namespace rayloc
