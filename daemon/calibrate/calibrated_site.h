// From what a calibration found to the files of a calibrated site.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "daemon/calibrate/access_point_stage.h"
#include "daemon/site/calibration_file.h"
#include "engine/calibrate/room_calibration.h"
#include "engine/room/room_model.h"

namespace rayloc {

// Of each access point in `results`: where it stands and turns against `surveyed`, its chains and
// the errors of the model. `calibrated`: the room, but for what `results` say, and how sure its
// parameters are.
std::vector<CalibratedAccessPoint> calibrated_access_points(
    const RoomModel& surveyed,
    const RoomCalibration& calibrated,
    std::span<const AccessPointResult> results);

// A method starts from the yaw that the gains were fitted with, in `start`; people count from the
// survey.
void count_yaw_from_survey(const RoomModel& surveyed,
                           const RoomModel& start,
                           std::vector<RoomParameter>& parameters);

// Mean gains and phases of the chains of an access point against its first.
std::vector<RoomParameter> chain_parameters(const CalibratedAccessPoint& access_point);

// The yaw and the errors of the model, which every method fits.
std::vector<RoomParameter> model_parameters(const CalibratedAccessPoint& access_point);

// Adds both of the above, but for what a method that fits arrays and chains has stated already.
void add_common_parameters(const CalibratedAccessPoint& access_point,
                           std::vector<RoomParameter>& parameters);

std::vector<CalibratedSurface> calibrated_surfaces(const RoomModel& room);

// The scene by file name: "scene.xml" and meshes; it reads back as the same scene.
std::map<std::string, std::string> refined_scene(const Scene& scene);

}  // namespace rayloc
