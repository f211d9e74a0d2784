// SiteFeed: provides the stream of a site as the sources of its access
// points, for a pipeline that runs on another machine than the capture nodes.
//
// The datagrams of the sources, and their watermarks, are a function of the records of the stream.
// A dead node must not block its site: after a period without it, although others are received, a
// record in the stream declares it silent. From there on its access points are not waited for,
// until it is received again; data that are then older than the watermarks promised meanwhile are
// late, and counted. An access point that no node has named yet is not waited for either.
//
// Load that cannot be processed is shed, by a record in the stream as well
// (shed_rule.h): so every later reader of the stream leaves out the same data.
//
// Thread safety: each source from one thread, the rest from any.
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "capture/transport/datagram_source.h"
#include "daemon/live/cluster/broker.h"
#include "daemon/live/cluster/feed/feed_lane.h"
#include "daemon/live/cluster/sequencer.h"
#include "daemon/live/cluster/shed_rule.h"
#include "daemon/live/cluster/site_resume.h"
#include "daemon/live/cluster/stream_reader.h"
#include "daemon/pipeline/stage_progress.h"

namespace rayloc {

class SiteFeed {
 public:
  using Time = std::chrono::steady_clock::time_point;

  struct Options {
    std::string site;
    std::vector<std::string> access_points;  // ids
    StreamOptions stream;                    // created where it does not exist
    SiteResume resume;                       // place to read from
    // For a replay: nothing is requested from nodes, and
    // the sources end after the message of that sequence.
    std::optional<std::uint64_t> until;
    // For a standby: nothing is requested or written until take_over().
    bool only_listens = false;
    // A node that is not received for so long, although others are, is silent.
    Duration silent_after = std::chrono::seconds(1);
    ShedRule::Limits shed;
    // Data missing for so long are requested.
    Duration ask_after = std::chrono::milliseconds(300);
    // Size of the queues of the sources, while each of them has data.
    std::size_t max_waiting_bytes = std::size_t{256} << 20U;
  };

  static Expected<std::unique_ptr<SiteFeed>> open(std::shared_ptr<Broker> broker, Options options);
  ~SiteFeed();
  SiteFeed(const SiteFeed&) = delete;
  SiteFeed& operator=(const SiteFeed&) = delete;

  // Source of the access point with that index in `access_points`; once each. This outlives it.
  std::unique_ptr<DatagramSource> source(std::size_t access_point);
  void start();
  // Ends the thread; sources deliver what is queued, and nothing more.
  void finish();
  // For a replay: the sources end now. From any thread.
  void end() { ending_ = true; }

  struct Counters {
    StreamReader::Counters stream;
    Sequencer::Counters batches;
    std::uint64_t refused = 0;   // unreadable records
    std::uint64_t unknown = 0;   // datagrams of access points that are not in the site
    std::uint64_t silences = 0;  // nodes declared silent
    std::uint64_t shed = 0;      // datagrams
    std::uint32_t shed_level = 0;
  };
  Counters counters() const;
  const StageProgress& progress() const { return progress_; }
  // Returns the latest place that precedes all data received at
  // `time` or later. No caller requests an earlier `time` afterwards.
  SiteResume resume_for(Timestamp time);
  // This worker owns the site from now on.
  void take_over() { only_listens_ = false; }
  // All instants before `time` are explained.
  void note_done(Timestamp time) { done_ = time; }

 private:
  struct Node {
    Time last_received;   // by our clock
    Time reported;        // last report of its silence
    bool silent = false;  // according to the stream
  };
  struct Checkpoint {
    SiteResume resume;
    Timestamp newest;  // of the data before it
  };

  SiteFeed(std::shared_ptr<Broker> broker, Options options);
  void run();
  void tend(Time now);
  void make_stream();
  void take(const BrokerMessage& message);
  void take_owner_record(const BrokerMessage& message);
  void deliver(Sequencer::Taken taken);
  bool is_waited_for(const FeedLane& lane) const;
  std::optional<Timestamp> promised() const;
  void promise_for_silent_ones();
  void ask_for_holes(Time now);
  void report_silent_nodes(Time now);
  void report_shedding(Time now);
  void wait_for_room();
  void note();
  void note_place();

  const std::shared_ptr<Broker> broker_;
  const Options options_;
  std::vector<std::shared_ptr<FeedLane>> lanes_;  // by access point
  std::shared_ptr<std::atomic<std::size_t>> waiting_bytes_;
  std::unique_ptr<StreamReader> reader_;
  Sequencer sequencer_;
  std::map<std::string, Node> nodes_;
  std::map<Sequencer::Hole, Time> holes_;  // due time of the request
  std::uint64_t refused_ = 0;
  std::uint64_t unknown_ = 0;
  std::uint64_t silences_ = 0;
  std::uint64_t shed_ = 0;
  std::uint32_t shed_level_;  // according to the stream
  ShedRule shed_rule_;
  std::uint64_t connections_ = 0;
  Timestamp newest_ = Timestamp::min();  // of the delivered data
  StageProgress progress_;
  std::atomic<Timestamp> done_{Timestamp::min()};
  std::atomic<bool> only_listens_;
  std::atomic<bool> ending_{false};
  mutable std::mutex mutex_;
  std::deque<Checkpoint> checkpoints_;  // guarded by mutex_; ascending, never empty
  Counters counters_;                   // guarded by mutex_
  std::thread thread_;
};

}  // namespace rayloc
