#include "daemon/cli/feed/feed_follower.h"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "daemon/messages/topic.h"
#include "engine/base/printable.h"
#include "rayloc/v1/envelope.pb.h"

namespace rayloc::cli {

FeedFollower::FeedFollower(FeedRequest request, FeedOutput output)
    : request_(std::move(request)), output_(std::move(output)), writer_(request_.format) {
  if (request_.topics.empty()) {
    request_.topics = {writer_.is_of_locations_only() ? "v1/location/" : "v1/"};
  }
}

std::vector<std::string> FeedFollower::prefixes() const {
  std::vector<std::string> prefixes = request_.topics;
  if (writer_.needs_heartbeats()) {
    prefixes.emplace_back(kHeartbeatTopics);
  }
  return prefixes;
}

Expected<void> FeedFollower::begin() {
  const std::optional<std::string> header = writer_.header();
  return header ? output_.write(*header) : Expected<void>();
}

Expected<void> FeedFollower::take(const PublishedMessage& message) {
  v1::Envelope envelope;
  if (!envelope.ParseFromString(message.payload)) {
    output_.note(fmt::format("a message of {} is no Envelope", printable(message.topic)));
    return {};
  }
  report_losses(message.topic, envelope);
  if (envelope.has_heartbeat() && writer_.needs_heartbeats()) {
    RAYLOC_TRY(writer_.receive(envelope.heartbeat()));
  }
  if (is_requested(message.topic)) {
    last_ = Clock::now();
    if (request_.filter.passes(envelope)) {
      writer_.add(std::move(envelope));
    }
  }
  return write_due();
}

void FeedFollower::report_left_out() const {
  const auto report = [&](std::uint64_t count, const char* what) {
    if (count > 0) {
      output_.note(fmt::format("{} messages {}", count, what));
    }
  };
  report(writer_.without_form(), "have no form in this format and were left out");
  report(writer_.dropped(), "were dropped while no heartbeat came");
}

bool FeedFollower::is_requested(const std::string& topic) const {
  return std::any_of(request_.topics.begin(),
                     request_.topics.end(),
                     [&](const std::string& prefix) { return topic.starts_with(prefix); });
}

void FeedFollower::report_losses(const std::string& topic, const v1::Envelope& envelope) {
  const std::uint64_t restarts = gaps_.restarts();
  for (const GapDetector::Gap& gap : gaps_.add(topic, envelope)) {
    output_.note(fmt::format("lost {} messages of {}", gap.lost, printable(gap.topic)));
  }
  if (gaps_.restarts() != restarts) {
    output_.note("the daemon was restarted");
  }
}

Expected<void> FeedFollower::write_due() {
  while (!is_done()) {
    const std::optional<std::string> line = writer_.next();
    if (!line) {
      return {};
    }
    RAYLOC_TRY(output_.write(*line));
    ++written_;
  }
  return {};
}

}  // namespace rayloc::cli
