#include "tests/e2e/listener.h"

#include <algorithm>
#include <utility>

#include "rayloc/v1/envelope.pb.h"
#include "tests/support/eventually.h"

namespace rayloc::e2e {

void add(const std::string& topic, const v1::Location& location, LocationBytes& locations) {
  locations[topic + " " + v1::LocationKind_Name(location.kind())].push_back(
      location.SerializeAsString());
}

Listener::Listener(const std::string& endpoint)
    : subscriber_(std::move(*Subscriber::connect(endpoint, {"v1/"}))), thread_([this] { run(); }) {}

Listener::~Listener() {
  stopping_ = true;
  if (thread_.joinable()) {
    thread_.join();
  }
}

bool Listener::wait_for_goodbye(std::chrono::seconds patience) {
  const bool came = eventually(patience, [this] { return goodbye_.load(); });
  stopping_ = true;
  thread_.join();
  std::sort(frames_.begin(), frames_.end());
  return came;
}

void Listener::run() {
  v1::Envelope envelope;
  while (!stopping_ && !goodbye_) {
    const auto message = subscriber_.receive(std::chrono::milliseconds(50));
    if (!message || !envelope.ParseFromString(message->payload)) {
      continue;
    }
    received_ = true;
    if (envelope.has_csi()) {
      envelope.mutable_csi()->clear_time();
      frames_.push_back(envelope.csi().SerializeAsString());
    } else if (envelope.has_location()) {
      add(message->topic, envelope.location(), locations_);
    } else if (envelope.has_goodbye()) {
      goodbye_ = true;
    }
  }
}

}  // namespace rayloc::e2e
