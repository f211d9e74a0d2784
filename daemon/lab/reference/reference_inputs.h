// ReferenceInputs: the calibrated site of a reference, and the recordings it is learned from.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "daemon/base/observer.h"
#include "daemon/site/model/site.h"
#include "daemon/site/survey/points_csv.h"
#include "engine/base/expected.h"
#include "engine/channel/csi_frame.h"
#include "engine/channel/mac_address.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct ReferenceOptions {
  std::string site;                       // directory of a calibrated site
  std::vector<std::string> captures;      // [AP=]FILE, of the empty room
  std::vector<std::string> people;        // [AP=]FILE, of a person at known places; may be empty
  std::vector<std::string> people_empty;  // [AP=]FILE, of the empty room of the day of `people`
  std::string points;                     // csv t_start,t_end,x,y,z of `people`
  std::string time_offset = "0";          // [s], added to the times of the points
  bool occupied = false;                  // a person walks about in `captures`
  std::filesystem::path out;              // folder for the new site, checked before any work
  bool force = false;                     // `out` may hold files
};

// Frames of fixed transmitters, by transmitter.
using FixedFrames = std::map<MacAddress, std::vector<CsiFrame>>;

struct ReferenceInputs {
  Site site;
  RoomModel room;
  FixedFrames empty;
  FixedFrames people_empty;  // empty unless people were recorded on another day
  FixedFrames people;        // empty without people
  std::vector<SurveyPoint> points;
  std::string points_file;  // for messages
  bool occupied = false;
  std::vector<std::string> notes;  // from the recordings
};

// Reads the site and the recordings; the notes of the scene go to the observer. Errors: options
// that do not fit together (kUsage), a site without a calibration or a fixed transmitter
// (kConfiguration), a recording without a frame of a fixed transmitter (kBadInput).
Expected<ReferenceInputs> read_reference_inputs(const ReferenceOptions& options,
                                                const Observer& observer);

}  // namespace rayloc
