#include "tests/e2e/csi_reader.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "daemon/messages/gap_detector.h"
#include "daemon/messages/proto_time.h"
#include "rayloc/v1/envelope.pb.h"

namespace rayloc::e2e {
namespace {

const char* const kFrames = "v1/csi/";

}  // namespace

CsiReader::CsiReader(const std::string& endpoint)
    : subscriber_(std::move(*Subscriber::connect(endpoint, {kFrames, "v1/heartbeat/"}))),
      thread_([this] { run(); }) {}

CsiReader::~CsiReader() {
  stopping_ = true;
  thread_.join();
}

double CsiReader::latency_ms(double quantile, std::size_t count) const {
  const std::lock_guard lock(mutex_);
  std::vector<float> newest(
      latencies_.end() - static_cast<std::ptrdiff_t>(std::min(count, latencies_.size())),
      latencies_.end());
  if (newest.empty()) {
    return 0.0;
  }
  const auto nth = static_cast<std::ptrdiff_t>(quantile * static_cast<double>(newest.size() - 1));
  std::nth_element(newest.begin(), newest.begin() + nth, newest.end());
  return static_cast<double>(newest[static_cast<std::size_t>(nth)]);
}

void CsiReader::run() {
  GapDetector gaps;
  v1::Envelope envelope;
  while (!stopping_) {
    const auto message = subscriber_.receive(std::chrono::milliseconds(50));
    if (!message || !envelope.ParseFromString(message->payload)) {
      continue;
    }
    for (const GapDetector::Gap& gap : gaps.add(message->topic, envelope)) {
      (gap.topic.rfind(kFrames, 0) == 0 ? lost_ : others_lost_) += gap.lost;
    }
    if (!envelope.has_csi()) {
      continue;
    }
    const Duration latency = from_proto(envelope.sent()) - from_proto(envelope.csi().time());
    {
      const std::lock_guard lock(mutex_);
      latencies_.push_back(static_cast<float>(to_seconds(latency) * 1e3));
    }
    ++messages_;
  }
}

}  // namespace rayloc::e2e
