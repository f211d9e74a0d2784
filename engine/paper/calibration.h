// calibrate: the published calibration of a room (METHODS A3): from the floor plan and the
// table of materials, alternately moves objects to lower the delay loss L_p and changes materials
// to lower the ratio-amplitude loss L_m (Loss), with the tracer's gradients.
//
// One iteration is a step of all positions and then, in the scene so moved, a step of all
// materials, each over all points that are not held out; no random numbers are used. The paper
// names no optimiser for this step; Rmsprop is used. Nothing is added to the paper: no prior, no
// posterior width, no pose of the arrays.
//
// Chain gains and yaw of the access points are taken from `room`: fit them before the call
// (AccessPointCalibrator).
#pragma once

#include <span>

#include "engine/base/expected.h"
#include "engine/calibrate/room_calibration.h"
#include "engine/observe/csi_ratio.h"
#include "engine/observe/savitzky_golay.h"
#include "engine/paper/rmsprop.h"
#include "engine/room/ray.h"

namespace rayloc::paper {

struct CalibrationOptions {
  int iterations = 300;
  int max_depth = kRayDepth;  // reflections
  // Width of a surface's soft edge [m] (METHODS A1, soft visibility).
  double softness = 0.05;
  SavitzkyGolayOptions smoothing = {};
  double floor = kRatioFloor;   // share of an antenna's power below which a tone is a null
  double object_rate = 1e-3;    // [m] a step
  double material_rate = 0.02;  // a step, relative to the value of the table
  RmspropOptions descent = {};
};

// History: the initial state and the state after every iteration, with its loss L_p + L_m over the
// points that are not held out. Returns the state with the least loss; held-out points are reported
// only. RoomModel::scene is new, its scene_hash and calibration_id are those given.
//
// Errors: as of gather_samples(), and kUsage for invalid options. REQUIRES: room.scene; h of
// each point has an entry for each access point, empty or [rx_chain][tone].
Expected<RoomCalibration> calibrate(const RoomModel& room,
                                    std::span<const CalibrationPoint> points,
                                    const CalibrationOptions& options = {},
                                    const CalibrationObserver& observer = {});

}  // namespace rayloc::paper
