// FeedFollower: the work of `rayloc sub`. It takes messages in order of arrival, selects those that
// are requested, writes them as lines, and reports losses.
//
// Thread safety: one thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "daemon/cli/feed/feed_writer.h"
#include "daemon/cli/feed/message_filter.h"
#include "daemon/live/publish/subscriber.h"
#include "daemon/messages/gap_detector.h"
#include "engine/base/expected.h"

namespace rayloc::cli {

struct FeedRequest {
  std::vector<std::string> topics = {};  // prefixes; empty: all topics that the format represents
  FeedFormat format = FeedFormat::kText;
  MessageFilter filter = {};
  std::uint64_t count = 0;  // number of lines after which it is done; 0: no end
};

struct FeedOutput {
  std::function<Expected<void>(const std::string& line)> write;
  std::function<void(const std::string& note)> note;  // for the user; neither has a newline
};

class FeedFollower {
 public:
  using Clock = std::chrono::steady_clock;

  FeedFollower(FeedRequest request, FeedOutput output);

  // Prefixes of the topics to subscribe to: those requested, and heartbeats if the format needs
  // them.
  std::vector<std::string> prefixes() const;

  // Writes the header, where the format has one.
  Expected<void> begin();
  // An Error where a line cannot be written, or the site states no georeference
  // and the format requires one. A message that cannot be parsed is reported.
  Expected<void> take(const PublishedMessage& message);
  bool is_done() const { return request_.count != 0 && written_ >= request_.count; }
  // Time since the last requested message; at first, since the construction.
  Clock::duration silence() const { return Clock::now() - last_; }
  // Reports the messages that were not written.
  void report_left_out() const;

 private:
  bool is_requested(const std::string& topic) const;
  void report_losses(const std::string& topic, const v1::Envelope& envelope);
  Expected<void> write_due();

  FeedRequest request_;
  FeedOutput output_;
  FeedWriter writer_;
  GapDetector gaps_;
  std::uint64_t written_ = 0;
  Clock::time_point last_ = Clock::now();
};

}  // namespace rayloc::cli
