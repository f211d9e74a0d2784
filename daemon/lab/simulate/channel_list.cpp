#include "daemon/lab/simulate/channel_list.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <span>
#include <string>
#include <system_error>

#include "engine/channel/wifi_band.h"

namespace rayloc {
namespace {

// Adjacent channels of 20 MHz, by number; each wider channel lies within one block.
struct Block {
  int first;
  int last;
  int step;  // from a channel of 20 MHz to the next
};

struct Band {
  double base_hz;          // frequency of number 0; 5 MHz per number
  int widest_mhz;          // largest simulated width
  std::string_view holds;  // for messages
  std::span<const Block> blocks;
};

// IEEE 802.11-2020, annex E, table E-4.
constexpr std::array kBlocksOf5GHz = {Block{36, 64, 4}, Block{100, 144, 4}, Block{149, 177, 4}};
constexpr std::array kBlocksOf2GHz = {Block{1, 13, 1}};
constexpr Band kBand5GHz = {5e9, 160, "36 to 64, 100 to 144 and 149 to 177", kBlocksOf5GHz};
constexpr Band kBand2GHz = {2.407e9, 20, "1 to 13, 20 MHz wide", kBlocksOf2GHz};

struct Numbers {
  int first = 0;
  int last = 0;
};

std::optional<int> number_of(std::string_view text) {
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || number < 0) {
    return std::nullopt;
  }
  return number;
}

// "36" or "36-48".
std::optional<Numbers> numbers_of(std::string_view part) {
  const std::size_t dash = part.find('-');
  const auto first = number_of(part.substr(0, dash));
  const auto last = dash == std::string_view::npos ? first : number_of(part.substr(dash + 1));
  if (!first || !last || *last < *first) {
    return std::nullopt;
  }
  return Numbers{*first, *last};
}

// All channels of the band that contain one of the numbers.
std::vector<RadioChannel> channels_of(const Band& band, const Numbers& numbers, int width_mhz) {
  const int parts = width_mhz / 20;
  std::vector<RadioChannel> found;
  for (const Block& block : band.blocks) {
    const int across = (parts - 1) * block.step;  // from the lowest part to the highest
    for (int low = block.first; low + across <= block.last; low += parts * block.step) {
      if (numbers.first <= low + across && low <= numbers.last) {
        found.push_back({band.base_hz + 2.5e6 * (2 * low + across), width_mhz});
      }
    }
  }
  return found;
}

}  // namespace

Expected<std::vector<RadioChannel>> parse_channels(std::string_view text,
                                                   const RadioChannel& site) {
  const WifiBand of = band_of(site.centre_hz);
  if (of == WifiBand::k6GHz) {
    return bad_input("the site's channel at " + to_string(site) +
                     " lies in a band for which AX-CSI has no channel numbers; they exist at 2.4 "
                     "and 5 GHz");
  }
  const Band& band = of == WifiBand::k2GHz ? kBand2GHz : kBand5GHz;
  std::vector<RadioChannel> channels;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string part(text.substr(begin, end - begin));
    begin = end + 1;
    const auto numbers = numbers_of(part);
    if (!numbers) {
      return bad_input("'" + part +
                       "' is neither a channel nor a range; write 36 or 36-64,100-144");
    }
    const bool is_wide = site.bandwidth_mhz > band.widest_mhz;
    const auto found =
        is_wide ? std::vector<RadioChannel>() : channels_of(band, *numbers, site.bandwidth_mhz);
    if (found.empty()) {
      return bad_input("no channel of " + std::to_string(site.bandwidth_mhz) + " MHz holds '" +
                       part + "'; the band of the site has " + std::string(band.holds));
    }
    channels.insert(channels.end(), found.begin(), found.end());
  }
  for (RadioChannel& channel : channels) {
    channel = is_same_channel(channel, site) ? site : channel;  // as the site states it
  }
  std::sort(channels.begin(), channels.end());
  channels.erase(std::unique(channels.begin(), channels.end()), channels.end());
  return channels;
}

}  // namespace rayloc
