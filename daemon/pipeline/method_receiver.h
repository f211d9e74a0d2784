// The receiver options that depend on the method that locates from the frames.
#pragma once

#include "capture/assemble/csi_receiver.h"
#include "daemon/methods/method.h"
#include "daemon/site/model/receiver_options.h"
#include "daemon/site/model/site.h"

namespace rayloc {

// Options for the datagrams of one access point, `index` into Site::access_points. `method`: null
// where nothing is located; the receiver then accepts all CSI.
inline CsiReceiverOptions receiver_options(const Site& site,
                                           std::size_t index,
                                           const Method* method) {
  CsiReceiverOptions options = receiver_options(site, index);
  if (method == nullptr) {
    options.accept_every_source();
  } else {
    options.accepts_hops = method->uses_every_channel;
  }
  return options;
}

}  // namespace rayloc
