// How the datagrams of a site's access point are to be read.
#pragma once

#include <cstddef>

#include "capture/assemble/csi_receiver.h"
#include "daemon/site/site.h"

namespace rayloc {

// `index`: into Site::access_points.
inline CsiReceiverOptions receiver_options(const Site& site, int index) {
  const SiteAccessPoint& access_point = site.access_points[static_cast<std::size_t>(index)];
  CsiReceiverOptions options;
  options.access_point = index;
  options.format = access_point.format;
  options.expected_cores = access_point.cores;
  return options;
}

}  // namespace rayloc
