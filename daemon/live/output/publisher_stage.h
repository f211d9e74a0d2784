// PublisherStage: the thread that owns the Publisher: takes the output of the sites (SiteOutput)
// and periodically the counters of each for a heartbeat, and sends goodbyes at the end.
//
// Thread safety: any thread, unless stated otherwise.
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

#include "daemon/live/output/site_output.h"
#include "daemon/live/publish/publisher.h"
#include "daemon/pipeline/stage_progress.h"

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

  // For a site that is being opened: it may produce output, which is published once it is added.
  std::shared_ptr<SiteOutput> make_output(SiteOutput::Options options);
  // Its output is published from now on, and its status is requested, after start().
  void add(const std::shared_ptr<SiteOutput>& output);
  // Its waiting output and its last heartbeat are still published and, if given, the `goodbye`. The
  // status of the site is not requested any more once this has returned.
  void remove(const std::shared_ptr<SiteOutput>& output, const std::optional<std::string>& goodbye);

  // One thread, as finish() and halt().
  void start();
  // Publishes waiting output, a last heartbeat and the goodbye of each site; ends the thread.
  void finish(const std::string& reason);
  // Ends the thread without a goodbye, after which no status is requested: for an incomplete start.
  // Done by the destructor as well.
  void halt();

  const std::string& endpoint() const { return publisher_.endpoint(); }
  PublishedCounters published() const;
  const StageProgress& progress() const { return progress_; }
  // Applies from the next heartbeat on.
  void set_heartbeat(Duration heartbeat) { heartbeat_ = heartbeat.count(); }

 private:
  struct Leaving {
    std::shared_ptr<SiteOutput> output;
    std::optional<StatusMessages> status;  // last status
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
