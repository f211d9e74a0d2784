// HandedSources: live sources of sites that a reload has ended, until the same sites continue with
// them. Their ports stay open: datagrams that arrive meanwhile wait in the buffer of the kernel,
// which counts its drops.
//
// Thread safety: one thread.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "capture/transport/datagram_source.h"
#include "daemon/live/config/config.h"

namespace rayloc {

class HandedSources {
 public:
  // `source` was opened by `config`, and is no longer read; one of a recording is released.
  void add(const SourceConfig& config, std::unique_ptr<DatagramSource> source);
  // The source that `config` would open, counting from zero; null where there is none.
  std::unique_ptr<DatagramSource> take(const SourceConfig& config);
  // Closes the sources of the site called `site`, except those that its `configs` would open.
  // Returns the number of their datagrams that waited unread or were dropped.
  std::uint64_t close_others(const std::string& site, const std::vector<SourceConfig>& configs);

 private:
  struct Handed {
    SourceConfig config;
    std::unique_ptr<DatagramSource> source;
    SourceCounters before;
  };
  std::vector<Handed> handed_;
};

}  // namespace rayloc
