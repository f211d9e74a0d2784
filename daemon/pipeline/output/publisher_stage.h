// PublisherStage: the thread that owns the Publisher: takes what the sites have to say (SiteOutput)
// and a heartbeat's worth of counters of each every so often, and says goodbye at the end.
//
// Thread safety: any thread, where nothing else is said.
#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "daemon/pipeline/output/site_output.h"
#include "daemon/pipeline/stage_progress.h"
#include "daemon/publish/publisher.h"

namespace rayloc {

class PublisherStage {
 public:
  struct Options {
    Duration heartbeat = std::chrono::seconds(1);
    std::function<Timestamp()> now;  // the clock of `sent`
  };

  PublisherStage(Publisher publisher, Options options);
  ~PublisherStage();
  PublisherStage(const PublisherStage&) = delete;
  PublisherStage& operator=(const PublisherStage&) = delete;

  // For a site that is being opened: it may speak, and is heard once it is added.
  std::shared_ptr<SiteOutput> make_output(SiteOutput::Options options);
  // What it says is published from now on, and its status is asked for, after start().
  void add(const std::shared_ptr<SiteOutput>& output);
  // What waits of it is still published, and its last heartbeat; with `goodbye`, that too. The site
  // is not asked any more once this has returned.
  void remove(const std::shared_ptr<SiteOutput>& output, const std::optional<std::string>& goodbye);

  // One thread, as finish() and halt().
  void start();
  // Publishes what waits, a last heartbeat and the goodbye of each site, and ends the thread.
  void finish(const std::string& reason);
  // Ends the thread without a goodbye, after which no site is asked any more: for a start that came
  // half-way. Done by the destructor as well.
  void halt();

  const std::string& endpoint() const { return publisher_.endpoint(); }
  PublishedCounters published() const;
  const StageProgress& progress() const { return progress_; }
  // From the next heartbeat on.
  void set_heartbeat(Duration heartbeat) { heartbeat_ = heartbeat.count(); }

 private:
  struct Leaving {
    std::shared_ptr<SiteOutput> output;
    std::optional<StatusMessages> status;  // the last
    std::optional<std::string> goodbye;
  };

  void run();
  void publish_waiting(SiteOutput& output);
  void publish_status(const SiteOutput& output, StatusMessages status, Timestamp now);
  void publish_goodbye(const SiteOutput& output, const std::string& reason);
  void let_go(Leaving leaving);
  void note_published(const std::vector<std::shared_ptr<SiteOutput>>& outputs);

  Publisher publisher_;  // used by the thread alone once it runs
  const Options options_;
  std::atomic<Duration::rep> heartbeat_;
  StageProgress progress_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::vector<std::shared_ptr<SiteOutput>> outputs_;  // guarded by mutex_
  std::vector<Leaving> leaving_;                      // guarded by mutex_
  PublishedCounters published_;                       // guarded by mutex_
  bool pending_ = false;                              // guarded by mutex_
  bool finishing_ = false;                            // guarded by mutex_
  std::thread thread_;
};

}  // namespace rayloc
