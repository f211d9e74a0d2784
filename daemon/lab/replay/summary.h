// Summary of a replay: the content of its recordings, and the counters of its pipeline.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "capture/source/recorded_source.h"
#include "daemon/pipeline/pipeline.h"

namespace rayloc::replay {

struct ReplayedSource {
  std::string access_point;
  std::string description;  // names the files
  std::uint64_t packets = 0;
  std::uint64_t rejected = 0;  // packets without CSI that can be used
  std::uint64_t frames = 0;
  std::uint64_t partial = 0;       // among the frames, those without some chains
  std::vector<std::string> notes;  // for people: clock steps, gaps, reasons of rejections
  std::string error;               // the reason for a premature end; empty: it was read completely
};

struct Summary {
  std::vector<ReplayedSource> sources;
  EstimationCounters counters;
  // The reason why there are packets, all readable, and no frame; empty otherwise.
  std::string no_frames;
};

// `recordings`: the pipeline's inputs, in their order. REQUIRES: the pipeline has ended.
Summary summarize(const Pipeline& pipeline, const std::vector<const RecordedSource*>& recordings);

}  // namespace rayloc::replay
