// Receiver options for the datagrams of a site's access point: CSI of another channel, or of
// several access points on one source, is rejected.
#pragma once

#include <chrono>
#include <cstddef>

#include "capture/assemble/csi_receiver.h"
#include "daemon/site/model/site.h"

namespace rayloc {

// `index`: into Site::access_points.
inline CsiReceiverOptions receiver_options(const Site& site, std::size_t index) {
  const SiteAccessPoint& access_point = site.access_points[index];
  CsiReceiverOptions options;
  options.access_point = index;
  options.format = access_point.format;
  options.expected_rx_chains = access_point.rx_chains;
  options.reject_mixture = true;
  options.settle = std::chrono::milliseconds(250);
  if (site.carrier.bandwidth_mhz > 0) {
    options.channel = RadioChannel{site.carrier.grid.centre_hz, site.carrier.bandwidth_mhz};
  }
  options.only_devices = true;
  for (const SiteTransmitter& transmitter : site.transmitters) {
    options.stated_transmitters.push_back(transmitter.mac);
  }
  return options;
}

}  // namespace rayloc
