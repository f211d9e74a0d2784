// UdpSource: the datagrams that arrive at a UDP port, with the kernel's time stamps.
//
// Receives unicast and broadcast IPv4. Datagrams from an interface or a sender that is not allowed,
// or longer than any CSI datagram, are rejected and counted; datagrams that the kernel dropped
// because the receive buffer was full are counted exactly (SO_RXQ_OVFL and, once the socket is
// idle, SO_MEMINFO). Thread safety: one thread reads; wake() and counters() from any.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "capture/transport/address_range.h"
#include "capture/transport/datagram_source.h"

namespace rayloc {

struct UdpSourceOptions {
  std::string address = "0.0.0.0:5500";    // HOST:PORT; port 0 selects a free one
  std::string interface = {};              // InterfaceFilter: only accepted interface; empty: all
  std::vector<AddressRange> senders = {};  // the only accepted senders; empty: all
  // An open and bound UDP socket to adopt (socket activation) instead of `address`.
  int adopted_fd = -1;
  // The default of 208 KiB loses datagrams at 10,000 a second.
  int receive_buffer_bytes = 8 << 20;
};

class UdpSource final : public DatagramSource {
 public:
  // The longest known CSI datagram has 1170 bytes.
  static constexpr std::size_t kMaxDatagramBytes = 4096;

  // kUnavailable if the port is in use or the interface does not exist, kUsage for an invalid
  // address.
  static Expected<std::unique_ptr<UdpSource>> open(const UdpSourceOptions& options);
  ~UdpSource() override;

  Expected<void> read(DatagramBatch& batch, Duration timeout) override;
  SourceCounters counters() const override;
  std::string description() const override;

  // Ends the read() that is waiting, or the next one, with an empty batch.
  void wake();

  std::uint16_t port() const;  // the bound port
  ReceiveBuffer receive_buffer() const override;
  std::optional<int> poll_descriptor() const override;

 private:
  class Impl;
  explicit UdpSource(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rayloc
