// BatchSender: sends the datagrams of one site that a capture node receives to the
// cluster: datagrams of all its access points become numbered batches, which go to
// the site's stream (numbered_ring.h keeps the batches that are still owed).
//
// It works in parallel with the recorder and never blocks it: an unreachable
// broker causes gap marks in the stream, and no loss in the recordings. The
// marked batches go to the history stream once all live data are sent. Thread
// safety: taps from a thread for each access point, the rest from any.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "daemon/live/cluster/broker.h"
#include "daemon/live/cluster/fill_queue.h"
#include "daemon/live/cluster/numbered_ring.h"
#include "daemon/pipeline/source_worker.h"
#include "daemon/pipeline/stage_progress.h"

namespace rayloc {

class BatchSender {
 public:
  struct Options {
    std::string site;
    std::string node;
    std::uint64_t epoch = 0;                         // of the node's start
    StreamOptions stream;                            // created where it does not exist
    Duration flush = std::chrono::milliseconds(20);  // the longest wait of a datagram for others
    Duration tick = std::chrono::milliseconds(100);  // between batches while nothing is received
    std::size_t max_datagrams = 64;                  // of a batch
    std::size_t max_bytes = std::size_t{64} << 10U;
    NumberedRing::Limits limits;
    FillQueue::Limits fill;
    std::function<bool()> clock_synchronised;
  };

  BatchSender(std::shared_ptr<Broker> broker, Options options);
  ~BatchSender();
  BatchSender(const BatchSender&) = delete;
  BatchSender& operator=(const BatchSender&) = delete;

  // Tap for the source of that access point; lives as long as this. REQUIRES: not started.
  DatagramTap& tap(const std::string& access_point);
  Expected<void> start();
  // Sends what waits, for as long as the broker accepts it and at most for
  // a second, and ends the thread. REQUIRES: no tap is called any more.
  void finish();

  // As NumberedRing::consumed() and ask(), for a node of that epoch.
  void consumed(std::uint64_t epoch, std::uint64_t number);
  void ask(std::uint64_t epoch, std::uint64_t from, std::uint64_t to);

  struct Counters {
    NumberedRing::Counters ring;
    NumberedRing::Counts captured;  // = in live batches + in gap marks + waiting
    // Part of those in gap marks: datagrams in the history stream, and
    // datagrams queued for it. The others are in the recordings alone.
    NumberedRing::Counts filled, to_fill;
    bool connected = false;
    std::uint64_t refused = 0;  // messages that the broker did not store
  };
  Counters counters() const;
  // Reason why the broker does not accept batches; empty while it does.
  std::string trouble() const;
  const StageProgress& progress() const { return progress_; }

 private:
  class Tap;
  using Time = std::chrono::steady_clock::time_point;
  struct Open {
    BatchPart part;
    Timestamp last_watermark = Timestamp::min();  // the last watermark in a batch
  };

  void take(std::size_t access_point, std::span<const Datagram> datagrams);
  void advance(std::size_t access_point, Timestamp watermark);
  void seal(Time now);
  void note_acknowledged(std::uint64_t number, const std::string& trouble);
  void run();
  bool next_round();
  Time due() const;
  void see_to_stream();
  void send_some();
  void send_history();
  void note_filled(std::uint64_t number, const std::string& trouble);
  std::string id_of(const NumberedRing::Ready& batch) const;
  void flush_all();

  const std::shared_ptr<Broker> broker_;
  const Options options_;
  const std::string subject_;
  const std::string fill_subject_;
  std::deque<Tap> taps_;
  StageProgress progress_;
  std::uint64_t connections_ = 0;  // used by the thread alone: at the last check of the stream
  Time checked_;                   // used by the thread alone; end of that check
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::vector<Open> open_;          // guarded by mutex_; by access point
  std::size_t open_datagrams_ = 0;  // guarded by mutex_
  std::size_t open_bytes_ = 0;      // guarded by mutex_
  Time opened_;                     // guarded by mutex_; of its first datagram
  Time sealed_;                     // guarded by mutex_; the last batch
  NumberedRing::Counts captured_;   // guarded by mutex_
  NumberedRing ring_;               // guarded by mutex_
  FillQueue fill_;                  // guarded by mutex_
  std::uint64_t refused_ = 0;       // guarded by mutex_
  std::string trouble_;             // guarded by mutex_
  bool is_stream_suspect_ = true;   // guarded by mutex_
  bool awake_ = false;              // guarded by mutex_: work is pending
  bool finishing_ = false;          // guarded by mutex_
  std::unique_ptr<Broker::AckedPublisher> publisher_;
  std::unique_ptr<Broker::AckedPublisher> fill_publisher_;
  std::thread thread_;
};

}  // namespace rayloc
