// Converts the result of a calibration to the files of a calibrated site.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "daemon/lab/calibrate/access_point_stage.h"
#include "daemon/site/model/calibration_file.h"
#include "engine/calibrate/room_calibration.h"
#include "engine/room/room_model.h"

namespace rayloc {

// For each access point in `results`: its pose change from `surveyed`,
// its chains and the errors of the model. `calibrated`: the room
// without the changes in `results`, and the sigma of its parameters.
std::vector<CalibratedAccessPoint> calibrated_access_points(
    const RoomModel& surveyed,
    const RoomCalibration& calibrated,
    std::span<const AccessPointResult> results);

// Refers yaw changes to the surveyed yaw. A method starts from the yaw in `start`, with which the
// gains were fitted; reports count from the survey.
void count_yaw_from_survey(const RoomModel& surveyed,
                           const RoomModel& start,
                           std::vector<RoomParameter>& parameters);

// Mean gains and phases of the chains of an access point relative to its first chain.
std::vector<RoomParameter> chain_parameters(const CalibratedAccessPoint& access_point);

// The yaw and the errors of the model, which every method fits.
std::vector<RoomParameter> model_parameters(const CalibratedAccessPoint& access_point);

// Adds both of the above, without those that a method for arrays and chains has already stated.
void add_common_parameters(const CalibratedAccessPoint& access_point,
                           std::vector<RoomParameter>& parameters);

std::vector<CalibratedSurface> calibrated_surfaces(const RoomModel& room);

// The scene by file name: "scene.xml" and meshes; it reads back as the same scene.
std::map<std::string, std::string> refined_scene(const Scene& scene);

}  // namespace rayloc
