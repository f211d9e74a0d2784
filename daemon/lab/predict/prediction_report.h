// A Prediction as a picture, as csv and as arrays of numpy.
#pragma once

#include <string>

#include "daemon/lab/predict/prediction.h"
#include "daemon/site/plan/drawing.h"
#include "engine/base/expected.h"
#include "engine/room/room_model.h"

namespace rayloc {

// Median of a place's errors [m]; a draw without a fix counts as infinite.
double median_error(const PredictedPlace& place);
// Share of its draws with an error above kAnotherPlace.
double another_place_share(const PredictedPlace& place);

// One dot per place, coloured by median_error(); a ring if some draw is at another place.
draw::Drawing prediction_picture(const Prediction& prediction, const RoomModel& room);

// x,y,z,median_m,another_place_share
std::string prediction_csv(const Prediction& prediction);

// position [place][3], error [place][draw], estimate [place][draw][3], all in metres.
Expected<void> write_npz(const Prediction& prediction, const std::string& path);

// Returns an Error (kUsage) for an ending other than .png, .svg, .csv and .npz.
Expected<void> check_prediction_file(const std::string& file);

// Writes one of the above, by the ending of the name. REQUIRES: check_prediction_file().
// kUnavailable if it cannot be written.
Expected<void> write_prediction(const Prediction& prediction,
                                const RoomModel& room,
                                const std::string& file);

}  // namespace rayloc
