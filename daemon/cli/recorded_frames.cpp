#include "daemon/cli/recorded_frames.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include "capture/csi_receiver.h"
#include "capture/pcap_source.h"
#include "daemon/site/receiver_options.h"

namespace rayloc::cli {

Expected<void> for_each_frame(const Site& site,
                              const CaptureArgument& capture,
                              const std::function<void(CsiFrame&&)>& take) {
  const auto index = find_access_point(site, capture.access_point);
  if (!index) {
    return tl::make_unexpected(index.error());
  }
  PcapFileOptions options;
  options.max_disorder = kAnyDisorder;
  auto source = PcapFileSource::open(capture.file, options);
  if (!source) {
    return tl::make_unexpected(std::move(source.error()));
  }
  CsiReceiver receiver(receiver_options(site, *index));
  DatagramBatch batch;
  std::vector<CsiFrame> frames;
  while (!batch.ended) {
    frames.clear();
    if (auto read = (*source)->read(batch, std::chrono::seconds(1)); !read) {
      return tl::make_unexpected(std::move(read.error()));
    }
    for (const Datagram& datagram : batch.datagrams) {
      receiver.push(datagram, frames);
    }
    if (batch.ended) {
      receiver.flush(frames);
    }
    for (CsiFrame& frame : frames) {
      take(std::move(frame));
    }
  }
  return {};
}

std::optional<MacAddress> keep_most_heard(std::vector<CsiFrame>& frames) {
  std::map<MacAddress, std::size_t> counts;
  for (const CsiFrame& frame : frames) {
    ++counts[frame.transmitter];
  }
  if (counts.size() < 2) {
    return std::nullopt;
  }
  const MacAddress most =
      std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) {
        return a.second < b.second;
      })->first;
  std::erase_if(frames, [&](const CsiFrame& frame) { return frame.transmitter != most; });
  return most;
}

}  // namespace rayloc::cli
