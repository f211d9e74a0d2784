// PcapLiveSource: the UDP datagrams that pass a network interface, through libpcap. For access
// points whose broadcasts no socket receives (WIRE_FORMATS 3.2), and for capturing beside a program
// that owns the port.
//
// Needs CAP_NET_RAW. Times are those of the kernel, truncated to microseconds. Thread safety: one
// thread reads; counters() from any.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "capture/transport/datagram_source.h"

namespace rayloc {

struct PcapLiveOptions {
  std::string interface = {};            // "eth7"
  std::string filter = "udp port 5500";  // pcap-filter(7)
  int buffer_bytes = 8 << 20;
};

class PcapLiveSource final : public DatagramSource {
 public:
  // kUnavailable when the interface does not exist or may not be captured; kUsage when the filter
  // is wrong.
  static Expected<std::unique_ptr<PcapLiveSource>> open(const PcapLiveOptions& options);
  ~PcapLiveSource() override;

  Expected<void> read(DatagramBatch& batch, Duration timeout) override;
  SourceCounters counters() const override;
  std::string description() const override;
  std::optional<int> poll_descriptor() const override;

 private:
  class Impl;
  explicit PcapLiveSource(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rayloc
