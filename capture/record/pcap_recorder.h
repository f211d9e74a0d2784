// PcapRecorder: writes datagrams to a classic pcap file (microseconds, Ethernet) that Wireshark,
// tcpreplay and PcapFileSource read; the generated Ethernet, IPv4 and UDP headers equal those of
// the access point's firmware.
//
// The file never ends inside a record, even if the program is killed: a separate process writes
// whole records (append_process.h), and a record that a full disk cut off is truncated away. Thread
// safety: one thread.
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

  // Appends the whole batch or none of it: an Error means that all of it is lost, but the file is
  // still whole, and the next batch may be tried (space may be free again). Times are truncated to
  // microseconds. Call it about ten times a second with the datagrams received since.
  Expected<void> write(std::span<const Datagram> batch);
  Expected<void> write(const DatagramBatch& batch) override { return write(batch.datagrams); }

  // Syncs the file to the disk, closes it, and continues in a new one, by the same process. After
  // an Error nothing has changed. Counters other than `bytes` continue.
  Expected<void> continue_in(const std::string& path);

  // Syncs the file. write() does so every few seconds, which bounds the loss at a power failure.
  Expected<void> sync() override;

  const SinkCounters& counters() const override { return counters_; }
  std::string description() const override { return path_; }
  const std::string& path() const { return path_; }
  // The file's descriptor, for locks; it remains owned by the recorder.
  int descriptor() const { return fd_; }

 private:
  PcapRecorder(int fd, std::string path, AppendProcess writer);

  Expected<void> append_records();
  tl::unexpected<Error> undo(int error);
  // Ends of records: the appends into which a batch is divided.
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
