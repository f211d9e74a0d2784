// GatewayRole: what the owners of sites say, out of the stream of results, to the sites of this
// gateway. It keeps no state: it begins behind the last word of each site. What was said while it
// was away is not told again, as nobody heard it; it is in the stream (`rayloc replay --stream`).
// What an owner says that was replaced, and what is repeated, is passed over.
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

#include "daemon/cluster/broker.h"
#include "daemon/cluster/stream_reader.h"
#include "daemon/pipeline/stage_progress.h"
#include "rayloc/v1/cluster.pb.h"

namespace rayloc {

// The records of one site in the order in which they count, whoever else wrote among them.
class OutputOrder {
 public:
  // Whether it is the next word of the site.
  bool is_next(const v1::OutputRecord& record);

 private:
  std::uint64_t generation_ = 0;
  std::uint64_t number_ = 0;
};

class GatewayRole {
 public:
  using Say = std::function<void(v1::OutputItem&& item)>;

  static Expected<std::unique_ptr<GatewayRole>> open(std::shared_ptr<Broker> broker,
                                                     StreamOptions stream);
  ~GatewayRole();
  GatewayRole(const GatewayRole&) = delete;
  GatewayRole& operator=(const GatewayRole&) = delete;

  // `say`: from a thread of its own, in the order of the results.
  void add(const std::string& site, Say say);
  void remove(const std::string& site);
  void start();
  void finish();

  struct Counters {
    std::uint64_t records = 0;
    std::uint64_t items = 0;
    std::uint64_t passed_over = 0;  // of owners that were replaced, repeated, or unreadable
    std::uint64_t lost = 0;         // that the stream did not have any more
  };
  Counters counters() const;
  const StageProgress& progress() const { return progress_; }

 private:
  struct Site {
    Say say;
    OutputOrder order;
    std::uint64_t from = 0;  // its last word when the reader began, which is passed over
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
  std::unique_ptr<StreamReader> reader_;  // used by the thread alone, as the next one
  Timestamp begun_{};                     // when the stream was made whose sequences `from` has
  mutable std::mutex mutex_;
  std::map<std::string, Site> sites_;  // guarded by mutex_; by subject
  Counters counters_;                  // guarded by mutex_
  std::thread thread_;
};

}  // namespace rayloc
