#include "tests/e2e/load_tally.h"

#include <gtest/gtest.h>

#include "tests/e2e/stated.h"

namespace rayloc::e2e {

std::uint64_t sent_by(const Process& sender) {
  for (const std::string& line : read_lines(sender.out())) {
    const nlohmann::json event = nlohmann::json::parse(line, nullptr, false);
    if (event.is_object() && event.value("event", "") == "end") {
      return event.at("datagrams").get<std::uint64_t>();
    }
  }
  ADD_FAILURE() << "the sender did not say how many\n" << sender.errors();
  return 0;
}

Tally tally_of(const nlohmann::json& heartbeat) {
  const nlohmann::json& c = heartbeat.at("sources").at(0).at("counters");
  Tally tally;
  tally.received = number(c.at("received"));
  for (const auto& [reason, count] : c.at("rejected").items()) {
    tally.rejected += number(count);
  }
  tally.kernel_drops = number(c.at("kernel_drops"));
  tally.ring_dropped = number(c.at("ring_dropped"));
  tally.processed = number(c.at("processed"));
  tally.in_flight = number(c.at("in_flight"));
  tally.frames = number(c.at("frames_complete")) + number(c.at("frames_partial"));
  tally.frames_dropped = number(c.at("frames_dropped"));
  tally.frames_processed = number(c.at("frames_processed"));
  tally.frames_in_flight = number(c.at("frames_in_flight"));
  return tally;
}

void expect_conserved(const Tally& t) {
  EXPECT_EQ(t.received, t.rejected + t.ring_dropped + t.processed + t.in_flight);
  EXPECT_EQ(t.frames, t.frames_dropped + t.frames_processed + t.frames_in_flight);
}

Tally settled(const LiveDaemon& daemon) {
  Tally last;
  eventually(std::chrono::seconds{30}, [&] {
    const std::vector<nlohmann::json> heartbeats = daemon.bodies("heartbeat");
    if (heartbeats.size() < 2) {
      return false;
    }
    const Tally before = tally_of(heartbeats[heartbeats.size() - 2]);
    last = tally_of(heartbeats.back());
    return last.received > 0 && before.received == last.received && last.in_flight == 0 &&
           last.frames_in_flight == 0;
  });
  return last;
}

Tally accounted(const LiveDaemon& daemon, std::uint64_t sent) {
  EXPECT_TRUE(eventually(std::chrono::seconds{60}, [&] {
    const Tally tally = tally_of(daemon.bodies("heartbeat").back());
    return tally.received + tally.kernel_drops == sent;
  })) << "unaccounted";
  const Tally tally = settled(daemon);
  expect_conserved(tally);
  EXPECT_EQ(tally.received + tally.kernel_drops, sent) << "unaccounted";
  EXPECT_EQ(tally.in_flight + tally.frames_in_flight, 0U);
  return tally;
}

std::vector<int> rates_of(const char* variable, int first) {
  first /= slower();
  if (is_stated(variable)) {
    return {first};
  }
  return {first, first / 2, first / 4, first / 8};
}

}  // namespace rayloc::e2e
