// calibrate_by_paper: the published calibration of a room (METHODS A3): from the floor plan and the
// table of materials, alternately moves objects to lower the delay loss L_p and changes materials
// to lower the ratio-amplitude loss L_m (PaperLoss), with gradients of the tracer.
//
// One iteration is a step of all positions and then, in the scene so moved, a step of all
// materials, each over all points that are not held out; nothing is drawn by chance. The paper
// names no optimiser here: it is Rmsprop. What the paper does not have is not added: no prior, no
// posterior width, no pose of the arrays.
//
// Chain gains and yaw of the access points are taken from `room`: fit them first
// (AccessPointCalibrator).
#pragma once

#include <span>

#include "engine/base/expected.h"
#include "engine/base/rmsprop.h"
#include "engine/calibrate/room_calibration.h"
#include "engine/observe/csi_ratio.h"
#include "engine/observe/savitzky_golay.h"
#include "engine/room/ray.h"

namespace rayloc {

struct PaperCalibrationOptions {
  int iterations = 300;
  int max_depth = kRayDepth;  // reflections
  // Over what distance from its edge a surface begins to act [m] (METHODS A1, soft visibility).
  double softness = 0.05;
  SavitzkyGolayOptions smoothing = {};
  double floor = kRatioFloor;   // share of an antenna's power below which a tone is a null
  double object_rate = 1e-3;    // [m] a step
  double material_rate = 0.02;  // a step, share of what the table says
  RmspropOptions descent = {};
};

// History: the state as given and after every iteration, its loss L_p + L_m over the points that
// are not held out, whatever it shows. What is returned is the state with the least of them; points
// held out only report. RoomModel::scene is new, its scene_hash and calibration_id are those given.
//
// An Error as of gather_paper_samples(), and for options that make no sense (kUsage).
// REQUIRES: room.scene; of each point h has an entry for each access point, empty or [core][tone].
Expected<RoomCalibration> calibrate_by_paper(const RoomModel& room,
                                             std::span<const CalibrationPoint> points,
                                             const PaperCalibrationOptions& options = {},
                                             const CalibrationObserver& observer = {});

}  // namespace rayloc
