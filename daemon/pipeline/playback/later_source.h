// LaterSource: a recording from a given time on. Earlier datagrams are counted as rejected, with
// the reason "before_the_start".
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <utility>

#include "capture/transport/datagram_source.h"

namespace rayloc {

class LaterSource : public DatagramSource {
 public:
  LaterSource(std::unique_ptr<DatagramSource> recording, Timestamp from)
      : recording_(std::move(recording)), from_(from) {}

  Expected<void> read(DatagramBatch& batch, Duration timeout) override;
  SourceCounters counters() const override;
  std::string description() const override { return recording_->description(); }

 private:
  std::unique_ptr<DatagramSource> recording_;
  const Timestamp from_;
  std::atomic<std::uint64_t> left_out_ = 0;
  std::atomic<std::uint64_t> left_out_bytes_ = 0;
};

}  // namespace rayloc
