// RecordedSource: the datagrams of one access point, from the files of a RecordingPlan, merged by
// time as if they were one. A file is opened when its time comes and closed at its end, so a ring
// of a thousand files needs only as many descriptors as files overlap.
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "capture/source/recording_plan.h"

namespace rayloc {

class RecordedSource final : public DatagramSource {
 public:
  static Expected<std::unique_ptr<RecordedSource>> open(RecordingPlan plan);
  // Scans the files first.
  static Expected<std::unique_ptr<RecordedSource>> open(const std::vector<std::string>& files,
                                                        const PcapFileOptions& options = {});

  // Same contract as PcapFileSource::read().
  Expected<void> read(DatagramBatch& batch, Duration timeout) override;
  SourceCounters counters() const override;
  std::string description() const override { return name_of(plan_); }

  const RecordingPlan& plan() const { return plan_; }
  std::vector<std::string> notices() const override { return describe(plan_); }
  // Torn records with their places, and findings that appear only when a pipe is read.
  std::vector<std::string> warnings() const override;

 private:
  struct Reader {
    std::unique_ptr<PcapFileSource> source;
    bool is_scanned = false;
    DatagramBatch batch;
    std::size_t next = 0;

    bool has_next() const { return next < batch.datagrams.size(); }
    const Datagram& front() const { return batch.datagrams[next]; }
  };

  explicit RecordedSource(RecordingPlan plan) : plan_(std::move(plan)) {}

  Expected<void> open_due();
  Expected<bool> fill(Duration timeout, bool may_read);
  void close_ended();
  void add_warnings(const Reader& reader, std::vector<std::string>& to) const;
  Timestamp watermark() const;
  void publish();

  const RecordingPlan plan_;
  std::size_t next_file_ = 0;
  std::vector<Reader> readers_;  // in the order of the files
  Timestamp watermark_ = Timestamp::min();
  SourceCounters closed_;              // counters of closed files
  std::vector<std::string> warnings_;  // warnings of closed files

  mutable std::mutex mutex_;
  SourceCounters published_;
};

}  // namespace rayloc
