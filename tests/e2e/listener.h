// Listener: everything that a daemon publishes until its goodbye, as it was sent.
#pragma once

#include <atomic>
#include <chrono>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "daemon/publish/subscriber.h"

namespace rayloc::v1 {
class Location;
}  // namespace rayloc::v1

namespace rayloc::e2e {

// v1::Location as bytes in the order in which they came; of each topic snapshots and what the
// tracker says by themselves: live a message is sent as soon as it is known, and a snapshot is
// known before the moments within it; a replay is sorted by time.
using LocationBytes = std::map<std::string, std::vector<std::string>>;
void add(const std::string& topic, const v1::Location& location, LocationBytes& locations);

class Listener {
 public:
  explicit Listener(const std::string& endpoint);
  ~Listener();
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  // Whether anything has come: from then on nothing is missed.
  bool heard() const { return heard_; }
  // False when the goodbye does not come. The rest is for after that.
  bool wait_for_goodbye(std::chrono::seconds patience);

  // v1::CsiFrame without its time, as bytes, sorted.
  const std::vector<std::string>& frames() const { return frames_; }
  const LocationBytes& locations() const { return locations_; }

 private:
  void run();

  Subscriber subscriber_;
  std::vector<std::string> frames_;
  LocationBytes locations_;
  std::atomic<bool> heard_ = false;
  std::atomic<bool> goodbye_ = false;
  std::atomic<bool> stopping_ = false;
  std::thread thread_;
};

}  // namespace rayloc::e2e
