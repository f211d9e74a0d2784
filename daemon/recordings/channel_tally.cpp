#include "daemon/recordings/channel_tally.h"

#include <algorithm>

#include <spdlog/fmt/fmt.h>

#include "capture/decode/decoder_registry.h"

namespace rayloc::cli {

void ChannelTally::add(std::span<const std::byte> payload) {
  ++datagrams_;
  if (const auto channel = radio_channel(payload)) {
    ++told_[*channel];
  }
}

std::optional<RadioChannel> ChannelTally::most() const {
  const auto most = std::find_if(
      told_.begin(), told_.end(), [this](const auto& one) { return 2 * one.second > datagrams_; });
  return most == told_.end() ? std::nullopt : std::optional(most->first);
}

std::string other_channel_text(const Site& site,
                               const std::string& access_point,
                               const RadioChannel& channel) {
  constexpr double kMHz = 1e6;  // [Hz]
  const OfdmGrid& grid = site.carrier.grid;
  if (grid.tone_index.empty()) {
    return "";
  }
  // A site may state a centre that no channel has: channels are numbered in steps of 5 MHz.
  constexpr double kSlackHz = 2.5e6;
  const double half = 0.5 * kMHz * channel.bandwidth_mhz + kSlackHz;
  const double lowest = grid.centre_hz + grid.spacing_hz * grid.tone_index.front();
  const double highest = grid.centre_hz + grid.spacing_hz * grid.tone_index.back();
  if (lowest >= channel.centre_hz - half && highest <= channel.centre_hz + half) {
    return "";
  }
  return fmt::format(
      "access point '{}' was tuned to {:.0f} MHz ({} MHz wide), as its datagrams say, and the site "
      "states {:.0f} MHz: write in site.toml, [carrier]: centre_hz = {:.0f} and its channel",
      access_point,
      channel.centre_hz / kMHz,
      channel.bandwidth_mhz,
      grid.centre_hz / kMHz,
      channel.centre_hz);
}

}  // namespace rayloc::cli
