// PcapRecorder: writes datagrams to a classic pcap file (microseconds, Ethernet) that Wireshark,
// tcpreplay and PcapFileSource read; the Ethernet, IPv4 and UDP headers are made up around them as
// the access point's firmware makes them.
//
// The file never ends inside a record, also when the program is killed: a process of its own writes
// whole records (append_process.h), and what a full disk cut off is truncated away again.
// Thread safety: one thread.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "capture/record/append_process.h"
#include "capture/transport/datagram_sink.h"
#include "engine/base/expected.h"

namespace rayloc {

class PcapRecorder final : public DatagramSink {
 public:
  // The file must not exist yet: a recording is never overwritten. kUnavailable otherwise.
  static Expected<PcapRecorder> create(const std::string& path);
  ~PcapRecorder() override;
  PcapRecorder(PcapRecorder&& other) noexcept;
  PcapRecorder& operator=(PcapRecorder&& other) = delete;

  // Appends the whole batch, or nothing of it: an Error means that all of it is lost, but the file
  // is still whole, and the next batch may be tried (there may be room again).
  // Times are truncated to microseconds. Call it some ten times a second with what has come since.
  Expected<void> write(std::span<const Datagram> batch);
  Expected<void> write(const DatagramBatch& batch) override { return write(batch.datagrams); }

  // Brings the file to the disk, closes it, and goes on in a new one, by the same process. After an
  // Error nothing has changed. Counters but `bytes` go on.
  Expected<void> continue_in(const std::string& path);

  // Brings the file to the disk. write() does so every few seconds: what a power failure may cost.
  Expected<void> sync() override;

  const SinkCounters& counters() const override { return counters_; }
  std::string description() const override { return path_; }
  const std::string& path() const { return path_; }
  // Of the file, for locks; it stays the recorder's.
  int descriptor() const { return fd_; }

 private:
  PcapRecorder(int fd, std::string path, AppendProcess writer);

  Expected<void> append_records();
  tl::unexpected<Error> undo(int error);
  // Where records end: the appends that a batch is divided into.
  std::size_t next_append(std::size_t begin, std::size_t& record) const;

  int fd_;
  std::string path_;
  AppendProcess writer_;
  std::vector<std::byte> records_;
  std::vector<std::size_t> record_ends_;
  std::chrono::steady_clock::time_point synced_;
  SinkCounters counters_;
};

}  // namespace rayloc
