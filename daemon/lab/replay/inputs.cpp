#include "daemon/lab/replay/inputs.h"

#include <memory>
#include <utility>

#include "daemon/lab/recordings/capture_argument.h"
#include "daemon/pipeline/method_receiver.h"
#include "daemon/pipeline/playback/later_source.h"
#include "daemon/pipeline/playback/paced_source.h"

namespace rayloc::replay {

Expected<Inputs> open_inputs(const Recordings& recordings,
                             const Site& site,
                             const Method& method,
                             Timestamp listen_from) {
  const auto captures =
      resolve_captures(recordings.captures, access_point_ids(site), PerAccessPoint::kSeveral);
  RAYLOC_TRY(captures);
  PcapFileOptions file_options;
  file_options.max_gap = recordings.max_gap;
  const auto pace =
      recordings.speed ? std::make_shared<Pace>(*recordings.speed, recordings.max_gap) : nullptr;
  Inputs all;
  for (const RecordingArgument& recording : recordings_of(*captures)) {
    auto source = RecordedSource::open(recording.files, file_options);
    RAYLOC_TRY(source);
    const std::size_t index = *find_access_point(site, recording.access_point);
    SourceInput input;
    input.access_point = recording.access_point;
    all.sources.push_back(source->get());
    all.access_points.push_back(index);
    input.source = std::move(*source);
    if (listen_from != Timestamp::min()) {
      input.source = std::make_unique<LaterSource>(std::move(input.source), listen_from);
    }
    if (pace) {
      input.source = std::make_unique<PacedSource>(std::move(input.source), pace);
    }
    input.receiver = receiver_options(site, index, &method);
    all.inputs.push_back(std::move(input));
  }
  return all;
}

}  // namespace rayloc::replay
