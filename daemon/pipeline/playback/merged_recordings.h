// MergedRecordings: the datagrams of several recordings in order of time, one at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "capture/transport/datagram_source.h"
#include "engine/base/expected.h"

namespace rayloc {

// Thread safety: one thread.
class MergedRecordings {
 public:
  // `is_stopped` ends the wait for a pipe without data; it is called between reads.
  MergedRecordings(std::vector<std::unique_ptr<DatagramSource>> sources,
                   std::function<bool()> is_stopped);

  struct Next {
    std::size_t recording = 0;           // position in the list of sources
    const Datagram* datagram = nullptr;  // nullptr: all recordings are at their end
  };
  // The earliest datagram; valid until the next call. An Error of a source ends the reading.
  Expected<Next> next();

  // Datagrams rejected while reading, by reason; sum over all recordings.
  std::map<std::string, std::uint64_t> rejected() const;
  // Findings of the sources from reading so far, a line each.
  std::vector<std::string> warnings() const;

 private:
  struct Recording {
    std::unique_ptr<DatagramSource> source;
    DatagramBatch batch;
    std::size_t next = 0;

    const Datagram* front() const {
      return next < batch.datagrams.size() ? &batch.datagrams[next] : nullptr;
    }
  };
  Expected<void> fill(Recording& recording) const;

  std::vector<Recording> recordings_;
  std::function<bool()> is_stopped_;
  Recording* last_ = nullptr;  // the recording of the latest datagram
};

}  // namespace rayloc
