// ChannelLog: records the channels that the datagrams of one access point state.
//
// Thread safety: one thread.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "capture/assemble/csi_receiver.h"
#include "engine/channel/radio_channel.h"

namespace rayloc {

class ChannelLog {
 public:
  // `expected`: the site's channel; empty: every channel is expected. `accepts_hops`: channels that
  // a device reaches from it by a hop (is_hop()) are expected as well.
  ChannelLog(std::optional<RadioChannel> expected, bool accepts_hops)
      : expected_(expected), accepts_hops_(accepts_hops) {}

  // Returns true if a frame of that channel may be used: it states none, or an expected one.
  bool add(const std::optional<RadioChannel>& channel, Timestamp time);

  std::uint64_t changes() const { return changes_ + (latest_ ? 1U : 0U); }
  // Names the latest channel and the site's if the latest is not expected. Empty otherwise.
  std::string trouble() const;
  void report(CsiReceiverCounters& counters) const;

 private:
  bool is_expected(const RadioChannel& channel) const;

  std::optional<RadioChannel> expected_;
  bool accepts_hops_;
  std::optional<RadioChannel> latest_;
  std::uint64_t changes_ = 0;
  std::vector<ChannelChange> first_changes_;
  std::map<RadioChannel, std::uint64_t> hops_;
};

}  // namespace rayloc
