// SiteOutput: the output of one site, until the publisher's thread takes it (publisher_stage.h).
//
// The estimation never waits for it: when more locations wait than `max_waiting`, the oldest one of
// the same target and kind is replaced by the newer, which states this (Envelope.coalesced); with
// as many events the oldest is dropped and counted. Queues belong to one site: a site with much
// output displaces none of another.
//
// Thread safety: location() and event() from one thread; compared(), tap() and counters() from any;
// take() and report() from the publisher's. compared() has a separate lock that no other function
// waits for: its callers have the lowest priority.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "daemon/live/publish/publisher.h"
#include "daemon/messages/location.h"
#include "daemon/messages/location_message.h"
#include "daemon/messages/target_event.h"
#include "daemon/pipeline/pipeline.h"
#include "rayloc/v1/heartbeat.pb.h"
#include "rayloc/v1/source.pb.h"

namespace rayloc {

struct SiteOutputCounters {
  std::uint64_t coalesced = 0;
  std::uint64_t events_dropped = 0;
  std::uint64_t csi_dropped = 0;
  // Totals of all sites together, as of the publisher's last update.
  PublishedCounters published;
};

// Content of one heartbeat; filled from the counters of all stages.
struct StatusMessages {
  v1::Heartbeat heartbeat;
  std::vector<v1::SourceState> sources;
};

class SiteOutput : public LocationSink, public FrameTap {
 public:
  struct Options {
    std::string site;                               // part of every topic
    std::shared_ptr<MessageBoard> board = nullptr;  // source of its viewers' messages; may be null
    std::size_t max_waiting = 1024;
    std::size_t max_waiting_csi = 8192;  // frames
    std::function<StatusMessages(Timestamp now)> status;
    // Lead of the clock of `sent` over event time; zero when empty.
    std::function<Duration()> clock_ahead = {};
    // Published name of a frame's transmitter.
    std::function<std::string(const CsiFrame& frame)> name = {};
  };
  using Event = std::variant<TrackEvent, ZoneEvent>;

  explicit SiteOutput(Options options) : options_(std::move(options)) {}

  const Options& options() const { return options_; }
  // Called whenever new output waits for the publisher; set before the first output.
  void on_something(std::function<void()> wake) { wake_ = std::move(wake); }

  void location(Location&& location) override;
  // Output of a method that is compared with the site's own; it replaces only output of such
  // methods. True: an older one was replaced.
  bool compared(Location&& location);
  void event(TrackEvent&& event) override { keep(std::move(event)); }
  void event(ZoneEvent&& event) override { keep(std::move(event)); }
  // For messages that were built by other code; as events, but in their order.
  using Message = std::variant<v1::Location, v1::TrackEvent, v1::ZoneEvent>;
  void relay(Message&& message);
  // Frames that are to be published unchanged; from any thread.
  void tap(const std::string& access_point, std::span<const CsiFrame> frames) override;

  struct WaitingLocation {
    Location location;
    std::uint32_t coalesced = 0;
  };
  struct WaitingCsi {
    std::string access_point;
    CsiFrame frame;
  };
  struct Waiting {
    std::deque<WaitingLocation> locations;
    std::deque<Event> events;
    std::deque<Message> messages;
    std::deque<WaitingCsi> csi;
    std::deque<WaitingLocation> compared;
  };
  // Returns the waiting output and removes it.
  Waiting take();
  // `options.status`, unless it is closed.
  std::optional<StatusMessages> report(Timestamp now);
  // `options.status` and the others are not called any more once this has returned.
  void close();

  void note_published(const PublishedCounters& published);
  SiteOutputCounters counters() const;

 private:
  void keep(Event&& event);
  static bool keep(Location&& location, std::size_t most, std::deque<WaitingLocation>& waiting);

  const Options options_;
  std::function<void()> wake_;
  mutable std::mutex mutex_;
  Waiting waiting_;  // guarded by mutex_
  std::mutex compared_mutex_;
  std::deque<WaitingLocation> compared_;  // guarded by compared_mutex_
  SiteOutputCounters counters_;           // guarded by mutex_
  std::mutex status_mutex_;               // held while the status of the site is requested
  bool closed_ = false;                   // guarded by status_mutex_
};

}  // namespace rayloc
