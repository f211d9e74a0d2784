// ChannelTally: which channel the datagrams of a recording say they were heard on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>

#include "capture/decode/radio_channel.h"
#include "daemon/site/site.h"

namespace rayloc::cli {

class ChannelTally {
 public:
  void add(std::span<const std::byte> payload);
  // That of more than half of all datagrams.
  std::optional<RadioChannel> most() const;

 private:
  std::map<RadioChannel, std::uint64_t> told_;
  std::uint64_t datagrams_ = 0;
};

// "access point 'ap1' was tuned to ...", where the tones of the site do not lie within that
// channel; empty where they do.
std::string other_channel_text(const Site& site,
                               const std::string& access_point,
                               const RadioChannel& channel);

}  // namespace rayloc::cli
