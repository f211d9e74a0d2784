// RelaySender: hands what a source has read to the UnixSource of another process.
//
// While the other end does not take anything, at most 100 ms are waited for it; what it has not
// taken by then, and what comes while it is not there, is lost and counted. The other end sees the
// same number as gaps in the sequence. Thread safety: none, one thread owns it.
#pragma once

#include <cstdint>
#include <string>

#include "capture/transport/datagram_source.h"
#include "capture/transport/relayed_datagram.h"

namespace rayloc {

struct RelayCounters {
  std::uint64_t sent = 0;
  std::uint64_t lost_full = 0;    // the other end did not take it in time
  std::uint64_t lost_absent = 0;  // nobody was there
};

class RelaySender {
 public:
  // `path` need not exist yet. kUsage when it is too long for a socket.
  static Expected<RelaySender> create(const std::string& path);
  ~RelaySender();
  RelaySender(RelaySender&& other) noexcept;
  RelaySender& operator=(RelaySender&& other) = delete;
  RelaySender(const RelaySender&) = delete;
  RelaySender& operator=(const RelaySender&) = delete;

  // The datagrams of a batch, in order; an empty one as a tick, which carries the watermark and
  // what was lost so far.
  void send(const DatagramBatch& batch, const SourceCounters& source);

  const RelayCounters& counters() const { return counters_; }
  // Whether the last send() found the other end.
  bool connected() const { return fd_ >= 0; }

 private:
  explicit RelaySender(std::string path);
  bool connect();
  void disconnect();
  void send_one(RelayHeader& header, std::span<const std::byte> payload);

  std::string path_;
  int fd_ = -1;
  bool stalled_ = false;  // the last one was not taken: no further wait until one is
  std::uint64_t epoch_;
  std::uint64_t sequence_ = 0;
  Timestamp watermark_{};
  RelayCounters counters_;
};

}  // namespace rayloc
