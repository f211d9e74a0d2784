// Listener: everything that a daemon publishes until its goodbye, as it was sent.
#pragma once

#include <atomic>
#include <chrono>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "daemon/live/publish/subscriber.h"

namespace rayloc::v1 {
class Location;
}  // namespace rayloc::v1

namespace rayloc::e2e {

// v1::Location as bytes in the order of arrival, by topic and kind: live, a message is sent as soon
// as its location is computed, and a snapshot is computed before the tracker's locations of its
// moments; a replay is sorted by time.
using LocationBytes = std::map<std::string, std::vector<std::string>>;
void add(const std::string& topic, const v1::Location& location, LocationBytes& locations);

class Listener {
 public:
  explicit Listener(const std::string& endpoint);
  ~Listener();
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  // True once anything was received: from then on nothing is missed.
  bool received() const { return received_; }
  // False if no goodbye arrives. The other functions are for after that.
  bool wait_for_goodbye(std::chrono::seconds patience);

  // v1::CsiFrame without its time, as bytes, sorted.
  const std::vector<std::string>& frames() const { return frames_; }
  const LocationBytes& locations() const { return locations_; }

 private:
  void run();

  Subscriber subscriber_;
  std::vector<std::string> frames_;
  LocationBytes locations_;
  std::atomic<bool> received_ = false;
  std::atomic<bool> goodbye_ = false;
  std::atomic<bool> stopping_ = false;
  std::thread thread_;
};

}  // namespace rayloc::e2e
