#include <algorithm>
#include <cmath>

#include "daemon/site/model/site_tables.h"
#include "engine/base/constants.h"
#include "engine/base/suggestion.h"

namespace rayloc {
namespace {

constexpr double kMinAntennaDistance = 1e-3;  // [m]; closer is the same antenna written twice

// Centre of an 802.11 channel of the 5 GHz band, or of the other bands that share its number.
// Source: IEEE 802.11-2020, 17.3.8.4.2, 19.3.15, 27.3.23.2.
std::vector<double> channel_centres_mhz(int channel) {
  std::vector<double> centres;
  if (channel <= 14) {
    centres.push_back(channel == 14 ? 2484.0 : 2407.0 + 5.0 * channel);
  }
  if (channel >= 32 && channel <= 177) {
    centres.push_back(5000.0 + 5.0 * channel);
  }
  centres.push_back(5950.0 + 5.0 * channel);  // 6 GHz
  return centres;
}

// The channel must be one of those in the stated band, or its centre.
void check_channel(const SiteTable& table, int channel, double bandwidth_mhz, double centre_hz) {
  const std::vector<double> centres = channel_centres_mhz(channel);
  const double reach = (bandwidth_mhz - 20.0) / 2.0 + 1.0;
  std::string stated;
  for (const double centre : centres) {
    if (std::abs(centre - centre_hz / 1e6) <= reach) {
      return;
    }
    stated += (stated.empty() ? "" : " or ") + to_text(centre);
  }
  table.error_at("centre_hz",
                 "'centre_hz' is " + to_text(centre_hz / 1e6) + " MHz, but channel " +
                     std::to_string(channel) + " lies at " + stated + " MHz, more than " +
                     to_text(reach - 1.0) + " MHz away; correct 'channel' or 'centre_hz'");
}

std::vector<std::int16_t> read_active(const SiteTable& carrier, std::int64_t tones) {
  const std::string example(site_key("carrier", "active").example);
  std::vector<std::int16_t> index;
  const auto ranges = carrier.pairs("active");
  if (!ranges) {
    return index;
  }
  const double low = -static_cast<double>(tones) / 2.0;
  const double high = static_cast<double>(tones) / 2.0 - 1.0;
  double next = low;
  for (const TomlTable::Pair& range : *ranges) {
    const auto [first, last] = range.values;
    if (first != std::trunc(first) || last != std::trunc(last) || first < next || last < first ||
        last > high) {
      carrier.error_at("active",
                       "'active' has [" + to_text(first) + ", " + to_text(last) +
                           "]; write ascending, separate ranges of whole tone numbers "
                           "from " +
                           to_text(low) + " to " + to_text(high) + ": " + example);
      return {};
    }
    for (int tone = static_cast<int>(first); tone <= static_cast<int>(last); ++tone) {
      index.push_back(static_cast<std::int16_t>(tone));
    }
    next = last + 1.0;
  }
  if (index.empty()) {
    carrier.error_at("active", "'active' names no tone; write " + example);
  }
  return index;
}

double read_angle(const SiteTable& table, std::string_view key) {
  return table.number(key).value_or(0.0) * kDegree;
}

void read_antenna(const SiteTable& table, SiteAccessPoint& access_point) {
  const std::optional<std::int64_t> rx_chain = table.integer("core");
  const auto offset = table.numbers<3>("offset");
  if (rx_chain &&
      std::find(access_point.rx_chains.begin(), access_point.rx_chains.end(), *rx_chain) !=
          access_point.rx_chains.end()) {
    table.error_at("core",
                   "core " + std::to_string(*rx_chain) +
                       " has an antenna already; each core "
                       "has one");
  }
  const Vec3d position = offset ? Vec3d{(*offset)[0], (*offset)[1], (*offset)[2]} : Vec3d{};
  if (offset && norm(position) > kMaxAntennaOffset) {
    table.error_at("offset",
                   "'offset' is " + to_text(norm(position)) +
                       " m long; it is from the access point's position, in metres");
  }
  for (const Vec3d& other : access_point.array.element_offset) {
    if (offset && norm(other - position) < kMinAntennaDistance) {
      table.error_at("offset", "another antenna of this access point is at the same place");
    }
  }
  if (rx_chain && offset) {  // otherwise an error exists, and the lists would get out of step
    access_point.rx_chains.push_back(static_cast<std::uint8_t>(*rx_chain));
    access_point.array.element_offset.push_back(position);
  }
}

void read_access_point_id(const SiteTable& table, const Site& site, SiteAccessPoint& out) {
  const std::optional<std::string> id = table.text("id");
  if (!id) {
    return;
  }
  if (!is_access_point_id(*id)) {
    table.error_at("id", "'id' is '" + *id + "'; write letters, digits, '-' and '_' only");
    return;
  }
  if (find_access_point(site, *id)) {
    table.error_at("id", "a second access point '" + *id + "'; give each its own id");
  }
  out.id = *id;
}

std::optional<MacAddress> read_mac(const SiteTable& table, const Site& site) {
  const std::optional<std::string> text = table.text("mac");
  if (!text) {
    return std::nullopt;
  }
  const Expected<MacAddress> mac = parse_mac_address(*text);
  if (!mac) {
    table.error_at("mac", mac.error().message);
    return std::nullopt;
  }
  if (find_transmitter(site, *mac) != nullptr) {
    table.error_at("mac", "a second transmitter " + to_string(*mac) + "; state each once");
  }
  return *mac;
}

SiteTransmitter read_transmitter(const SiteTable& table, const Site& site) {
  SiteTransmitter out;
  const std::optional<std::string> role = table.choice("role");
  const bool fixed = role == "fixed";
  out.role = fixed ? TransmitterRole::kFixed : TransmitterRole::kDevice;
  out.mac = read_mac(table, site).value_or(MacAddress{});
  out.name = table.text("name").value_or("");
  out.position = read_position(table, site);
  out.height = table.number("height_m").value_or(site.targets.height);
  out.height_sigma = table.number("height_sigma_m").value_or(site.targets.height_sigma);
  out.pattern = read_pattern(table);
  out.polarization = read_polarization(table);
  out.constant_power = table.boolean("constant_power").value_or(false);
  if (fixed) {
    table.require("position");
    if (table.has("height_m")) {
      table.error_at("height_m",
                     "'height_m' of a fixed transmitter is in its 'position'; remove it");
    }
  } else if (role && table.has("position")) {
    table.error_at("position",
                   "the 'position' of a device is what is looked for; remove it, or "
                   "write role = \"fixed\"");
  }
  return out;
}

}  // namespace

void read_carrier(const SiteTable& carrier, Carrier& out) {
  const auto channel = carrier.integer("channel");
  const auto bandwidth = carrier.integer("bandwidth_mhz");
  const auto centre = carrier.number("centre_hz");
  const auto tones = carrier.integer("tones");
  const auto spacing = carrier.number("tone_spacing_hz");
  out.channel = static_cast<int>(channel.value_or(0));
  out.bandwidth_mhz = static_cast<int>(bandwidth.value_or(0));
  out.grid.centre_hz = centre.value_or(0.0);
  out.grid.spacing_hz = spacing.value_or(out.grid.spacing_hz);
  carrier.toml().ask_for("active");
  if (bandwidth && channel && centre) {
    check_channel(carrier, out.channel, static_cast<double>(*bandwidth), *centre);
  }
  if (!bandwidth || !tones) {
    return;
  }
  const double wanted = static_cast<double>(*bandwidth) * 1e6 / out.grid.spacing_hz;
  if (static_cast<double>(*tones) != wanted) {
    carrier.error_at("tones",
                     "'tones' is " + std::to_string(*tones) + ", but " +
                         std::to_string(*bandwidth) + " MHz hold " + to_text(wanted) +
                         " tones of " + to_text(out.grid.spacing_hz) + " Hz");
    return;
  }
  out.grid.tone_index = read_active(carrier, *tones);
}

void read_access_points(std::span<const SiteTable> tables, Site& site) {
  for (const SiteTable& table : tables) {
    SiteAccessPoint out;
    read_access_point_id(table, site, out);
    out.format = table.choice("format").value_or("");
    out.array.pose.position = read_position(table, site).value_or(Vec3d{});
    out.array.pose.orientation = {read_angle(table, "yaw_deg"),
                                  read_angle(table, "pitch_deg"),
                                  read_angle(table, "roll_deg")};
    out.array.pattern = read_pattern(table);
    out.array.polarization = read_polarization(table);
    for (const SiteTable& antenna : table.tables("antenna")) {
      read_antenna(antenna, out);
    }
    site.access_points.push_back(std::move(out));
  }
}

void read_transmitters(const SiteTable& root, Site& site) {
  for (const SiteTable& table : root.tables("transmitter")) {
    site.transmitters.push_back(read_transmitter(table, site));
  }
}

}  // namespace rayloc
