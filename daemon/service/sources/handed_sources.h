// HandedSources: live sources of sites that a reload has ended, until the same sites go on with
// them. Their ports stay open: what comes meanwhile waits in the buffer of the kernel, which counts
// what it drops.
//
// Thread safety: one thread.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "capture/transport/datagram_source.h"
#include "daemon/config/config.h"

namespace rayloc {

class HandedSources {
 public:
  // `source` was opened by `config`, and nobody reads it any more; one of a recording is let go of.
  void add(const SourceConfig& config, std::unique_ptr<DatagramSource> source);
  // The one that `config` would open, counting from zero; null where there is none.
  std::unique_ptr<DatagramSource> take(const SourceConfig& config);
  // Lets go of those of the site called `site` but for what its `configs` would open. How many
  // datagrams had come by then, and were dropped or wait in vain.
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
