// PublisherStage: the thread that owns the Publisher: takes locations from the estimation thread
// and a heartbeat's worth of counters every so often, and says goodbye at the end.
//
// The estimation thread never waits for it: when more locations wait than `max_waiting`, the oldest
// one of the same target and kind is replaced by the newer, which says so (Envelope.coalesced); of
// as many events the oldest is dropped, and counted.
//
// Thread safety: location() and event() from one thread; counters() from any.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "daemon/pipeline/pipeline.h"
#include "daemon/publish/location.h"
#include "daemon/publish/publisher.h"
#include "daemon/publish/target_event.h"
#include "rayloc/v1/heartbeat.pb.h"
#include "rayloc/v1/source.pb.h"

namespace rayloc {

struct PublisherStageCounters {
  std::uint64_t coalesced = 0;
  std::uint64_t events_dropped = 0;
  std::uint64_t csi_dropped = 0;
  PublishedCounters published;  // as of the last time that the thread had something to say
};

// What is said once per heartbeat; filled by the service from the counters of all stages.
struct StatusMessages {
  v1::Heartbeat heartbeat;
  std::vector<v1::SourceState> sources;
};

class PublisherStage : public LocationSink, public FrameTap {
 public:
  struct Options {
    Duration heartbeat = std::chrono::seconds(1);
    std::size_t max_waiting = 1024;
    std::size_t max_waiting_csi = 8192;  // frames
    std::function<StatusMessages(Timestamp now)> status;
    std::function<Timestamp()> now;  // the clock of `sent`
    // What that clock is later than event time; zero when empty.
    std::function<Duration()> clock_ahead = {};
    // What the transmitter of a frame is called outside.
    std::function<std::string(const CsiFrame& frame)> name;
  };

  PublisherStage(Publisher publisher, Options options);
  ~PublisherStage() override;
  PublisherStage(const PublisherStage&) = delete;
  PublisherStage& operator=(const PublisherStage&) = delete;

  // `options.status` is first called after this.
  void start();
  void location(Location&& location) override;
  void event(TrackEvent&& event) override { keep(std::move(event)); }
  void event(ZoneEvent&& event) override { keep(std::move(event)); }
  // Of frames that are to be published as they are; from any thread.
  void tap(const std::string& access_point, std::span<const CsiFrame> frames) override;

  // Publishes what waits, a last heartbeat and the goodbye, and ends the thread.
  void finish(const std::string& reason);
  // Ends the thread without a goodbye, after which `options.status` is not called any more: for a
  // start that came half-way. Done by the destructor as well.
  void halt();

  const std::string& endpoint() const { return publisher_.endpoint(); }
  PublisherStageCounters counters() const;
  const StageProgress& progress() const { return progress_; }
  // From the next heartbeat on; from any thread.
  void set_heartbeat(Duration heartbeat) { heartbeat_ = heartbeat.count(); }

 private:
  struct Waiting {
    Location location;
    std::uint32_t coalesced = 0;
  };

  struct WaitingCsi {
    std::string access_point;
    CsiFrame frame;
  };

  using Event = std::variant<TrackEvent, ZoneEvent>;

  void keep(Event&& event);
  void run();
  void publish_csi(std::deque<WaitingCsi>& frames);
  void publish_status();
  void note_published();

  Publisher publisher_;  // used by the thread alone once it runs
  const Options options_;
  std::atomic<Duration::rep> heartbeat_;
  StageProgress progress_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<Waiting> waiting_;      // guarded by mutex_
  std::deque<Event> events_;         // guarded by mutex_
  std::deque<WaitingCsi> csi_;       // guarded by mutex_
  PublisherStageCounters counters_;  // guarded by mutex_
  bool finishing_ = false;           // guarded by mutex_
  std::thread thread_;
};

}  // namespace rayloc
