#include "daemon/lab/reference/reference_inputs.h"

#include <algorithm>
#include <utility>

#include "daemon/lab/recordings/capture_argument.h"
#include "daemon/lab/recordings/fixed_frames.h"
#include "daemon/site/model/room_model.h"
#include "daemon/site/model/site_copy.h"
#include "daemon/site/scene/scene_notes.h"
#include "daemon/site/survey/time_offset.h"
#include "engine/scene/scene.h"

namespace rayloc {
namespace {

Expected<FixedFrames> read_captures(const Site& site,
                                    const std::vector<std::string>& arguments,
                                    std::vector<std::string>& notes) {
  const auto captures =
      resolve_captures(arguments, access_point_ids(site), PerAccessPoint::kSeveral);
  RAYLOC_TRY(captures);
  auto frames = read_fixed_frames(site, *captures, notes);
  RAYLOC_TRY(frames);
  for (const RecordingArgument& recording : recordings_of(*captures)) {
    const std::size_t index = *find_access_point(site, recording.access_point);
    const bool received = std::any_of(frames->begin(), frames->end(), [&](const auto& entry) {
      return std::any_of(entry.second.begin(), entry.second.end(), [&](const CsiFrame& frame) {
        return frame.access_point == index;
      });
    });
    if (!received) {
      std::string message = files_text(recording) + ": access point '" + recording.access_point +
                            "' received no fixed transmitter of the site; give a recording of one "
                            "of the [[transmitter]] with role = \"fixed\"";
      for (const std::string& note : notes) {
        message += "\n" + note;
      }
      return bad_input(message);
    }
  }
  return frames;
}

Expected<void> check_options(const ReferenceOptions& options) {
  if (options.people.empty() != options.points.empty()) {
    return make_error(ErrorKind::kUsage,
                      "--people and --points belong together: recordings of people at known "
                      "places, and a csv t_start,t_end,x,y,z of the places");
  }
  if (options.people.empty() && !options.people_empty.empty()) {
    return make_error(ErrorKind::kUsage,
                      "--people-empty is the empty room of the day of --people; give these, too");
  }
  return {};
}

Expected<Site> load_site_of(const ReferenceOptions& options) {
  auto site = load_calibrated_site(options.site,
                                   ", and a person is found in a calibrated room only: "
                                   "run `rayloc calibrate` first",
                                   options.out,
                                   options.force);
  if (site && std::none_of(site->transmitters.begin(),
                           site->transmitters.end(),
                           [](const auto& one) { return one.role == TransmitterRole::kFixed; })) {
    return make_error(ErrorKind::kConfiguration,
                      options.site +
                          ": states no fixed transmitter; add a [[transmitter]] with role = "
                          "\"fixed\" and its position to site.toml");
  }
  return site;
}

Expected<void> read_people(const ReferenceOptions& options, ReferenceInputs& inputs) {
  auto people = read_captures(inputs.site, options.people, inputs.notes);
  RAYLOC_TRY(people);
  inputs.people = *std::move(people);
  auto points = load_points_csv(options.points, options.time_offset);
  RAYLOC_TRY(points);
  inputs.points = *std::move(points);
  inputs.points_file = options.points;
  return {};
}

Expected<void> read_recordings(const ReferenceOptions& options, ReferenceInputs& inputs) {
  auto empty = read_captures(inputs.site, options.captures, inputs.notes);
  RAYLOC_TRY(empty);
  inputs.empty = *std::move(empty);
  inputs.occupied = options.occupied;
  if (!options.people_empty.empty()) {
    auto people_empty = read_captures(inputs.site, options.people_empty, inputs.notes);
    RAYLOC_TRY(people_empty);
    inputs.people_empty = *std::move(people_empty);
  }
  return options.people.empty() ? Expected<void>() : read_people(options, inputs);
}

}  // namespace

Expected<ReferenceInputs> read_reference_inputs(const ReferenceOptions& options,
                                                const Observer& observer) {
  RAYLOC_TRY(check_options(options));
  auto site = load_site_of(options);
  RAYLOC_TRY(site);
  ReferenceInputs inputs;
  inputs.site = *std::move(site);
  auto room = load_room_model(inputs.site);
  RAYLOC_TRY(room);
  inputs.room = *std::move(room);
  note_scene(*inputs.room.scene, observer);
  RAYLOC_TRY(read_recordings(options, inputs));
  return inputs;
}

}  // namespace rayloc
