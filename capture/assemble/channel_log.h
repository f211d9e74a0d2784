// ChannelLog: the channels that the datagrams of one access point state.
//
// Thread safety: one thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "capture/assemble/csi_receiver.h"
#include "engine/channel/radio_channel.h"

namespace rayloc {

class ChannelLog {
 public:
  // `expected`: the site's channel; nothing: every channel is.
  explicit ChannelLog(std::optional<RadioChannel> expected) : expected_(expected) {}

  // Returns whether a frame of that channel may be used: it states none, or the expected one.
  bool add(const std::optional<RadioChannel>& channel, Timestamp time);

  std::uint64_t changes() const { return changes_ + (latest_ ? 1U : 0U); }
  // The latest channel is not the expected one: names both. Empty otherwise.
  std::string trouble() const;
  void report(CsiReceiverCounters& counters) const;

 private:
  std::optional<RadioChannel> expected_;
  std::optional<RadioChannel> latest_;
  std::uint64_t changes_ = 0;
  std::vector<ChannelChange> first_changes_;
};

}  // namespace rayloc
