// DSCP: locates a person without a device by images of the amplitude differences between the
// antennas of each access point, in the channel of a fixed transmitter [DS].
//
// Every surveyed place is a class; `cell_m` merges places to areas, as in the paper. Ours: a class
// of the empty room; without it a person is always detected.
//
// References: [DS] DSCP: depthwise separable convolution passive location, WCMC 2021.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "engine/base/expected.h"
#include "engine/baselines/places/place_classifier.h"
#include "engine/baselines/settings.h"
#include "engine/baselines/training.h"

namespace rayloc {

std::span<const BaselineSetting> dscp_settings();

// See make_cifi().
Expected<PlaceClassifier> make_dscp(std::shared_ptr<const RoomModel> room,
                                    const BaselineValues& values,
                                    std::uint64_t seed,
                                    double accuracy_confidence,
                                    std::shared_ptr<const Training> training);

Expected<std::shared_ptr<const Training>> train_dscp(const TrainingInput& input);

}  // namespace rayloc
