// UdpSender: datagrams to one UDP endpoint, many by one system call.
#pragma once

#include <netinet/in.h>

#include <memory>
#include <string>

#include "capture/transport/datagram_sink.h"
#include "capture/transport/file_descriptor.h"

namespace rayloc {

class UdpSender final : public DatagramSink {
 public:
  // `address` is HOST:PORT; kUsage when it is none.
  static Expected<std::unique_ptr<UdpSender>> open(const std::string& address);

  // Whether anybody listens at the destination is not known, as it is not to the access point.
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
