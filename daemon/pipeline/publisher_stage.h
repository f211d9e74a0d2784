// PublisherStage: the thread that owns the Publisher: takes locations from the estimation thread
// and a heartbeat's worth of counters every so often, and says goodbye at the end.
//
// The estimation thread never waits for it: when more locations wait than `max_waiting`, the oldest
// one of the same target and kind is replaced by the newer, which says so (Envelope.coalesced).
//
// Thread safety: location() from one thread; counters() from any.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "daemon/pipeline/pipeline.h"
#include "daemon/publish/publisher.h"
#include "rayloc/v1/heartbeat.pb.h"
#include "rayloc/v1/location.pb.h"
#include "rayloc/v1/source.pb.h"

namespace rayloc {

struct PublisherStageCounters {
  std::uint64_t coalesced = 0;
};

// What is said once per heartbeat; filled by the service from the counters of all stages.
struct StatusMessages {
  v1::Heartbeat heartbeat;
  std::vector<v1::SourceState> sources;
};

class PublisherStage : public LocationSink {
 public:
  struct Options {
    Duration heartbeat = std::chrono::seconds(1);
    std::size_t max_waiting = 1024;
    std::function<StatusMessages(Timestamp now)> status;
    std::function<Timestamp()> now;  // the clock of `sent`
  };

  PublisherStage(Publisher publisher, Options options);
  ~PublisherStage() override;
  PublisherStage(const PublisherStage&) = delete;
  PublisherStage& operator=(const PublisherStage&) = delete;

  // `options.status` is first called after this.
  void start();
  void location(v1::Location&& location) override;

  // Publishes what waits, a last heartbeat and the goodbye, and ends the thread.
  void finish(const std::string& reason);

  const std::string& endpoint() const { return publisher_.endpoint(); }
  PublisherStageCounters counters() const;

 private:
  struct Waiting {
    v1::Location location;
    std::uint32_t coalesced = 0;
  };

  void run();
  void publish_status();

  Publisher publisher_;  // used by the thread alone once it runs
  const Options options_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<Waiting> waiting_;      // guarded by mutex_
  PublisherStageCounters counters_;  // guarded by mutex_
  bool finishing_ = false;           // guarded by mutex_
  std::thread thread_;
};

}  // namespace rayloc
