// GatewayRole: passes the results of the owners of sites from the stream of results to the
// sites of this gateway. It keeps no state: it begins after the last record of each site.
// Results published while it was away are not sent later; they remain in the stream
// (`rayloc replay --stream`). Records of a replaced owner and repeated records are skipped.
//
// Thread safety: add() before start(), the rest from any thread.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "daemon/live/cluster/broker.h"
#include "daemon/live/cluster/stream_reader.h"
#include "daemon/pipeline/stage_progress.h"
#include "rayloc/v1/cluster.pb.h"

namespace rayloc {

// Accepts the valid records of one site in order, regardless of records of other writers.
class OutputOrder {
 public:
  // Returns true if it is the next valid record of the site.
  bool is_next(const v1::OutputRecord& record);

 private:
  std::uint64_t generation_ = 0;
  std::uint64_t number_ = 0;
};

class GatewayRole {
 public:
  using Deliver = std::function<void(v1::OutputItem&& item)>;

  static Expected<std::unique_ptr<GatewayRole>> open(std::shared_ptr<Broker> broker,
                                                     StreamOptions stream);
  ~GatewayRole();
  GatewayRole(const GatewayRole&) = delete;
  GatewayRole& operator=(const GatewayRole&) = delete;

  // `deliver`: called from a thread of the role, in the order of the results.
  void add(const std::string& site, Deliver deliver);
  void remove(const std::string& site);
  void start();
  void finish();

  struct Counters {
    std::uint64_t records = 0;
    std::uint64_t items = 0;
    std::uint64_t passed_over = 0;  // from replaced owners, repeated, or unreadable
    std::uint64_t lost = 0;         // no longer in the stream
  };
  Counters counters() const;
  const StageProgress& progress() const { return progress_; }

 private:
  struct Site {
    Deliver deliver;
    OutputOrder order;
    std::uint64_t from = 0;  // last record when the reader began, which is skipped
  };

  GatewayRole(std::shared_ptr<Broker> broker, StreamOptions stream)
      : broker_(std::move(broker)), stream_(std::move(stream)) {}
  void run();
  bool open_reader();
  void take(const BrokerMessage& message);

  const std::shared_ptr<Broker> broker_;
  const StreamOptions stream_;
  StageProgress progress_;
  std::atomic<bool> ending_{false};
  std::unique_ptr<StreamReader> reader_;  // used by the thread alone, as is begun_
  Timestamp begun_{};                     // creation time of the stream whose sequences `from` has
  mutable std::mutex mutex_;
  std::map<std::string, Site> sites_;  // guarded by mutex_; by subject
  Counters counters_;                  // guarded by mutex_
  std::thread thread_;
};

}  // namespace rayloc
