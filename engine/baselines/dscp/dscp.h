// DSCP: a person who carries nothing, by images of the differences of amplitude between the
// antennas of each access point, in the channel of a fixed transmitter [DS].
//
// Every place at which somebody stood is a class; `cell_m` merges them to areas, as the paper has
// it. Ours: a class of the empty room, without which somebody is always seen.
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

// As make_cifi().
Expected<PlaceClassifier> make_dscp(std::shared_ptr<const RoomModel> room,
                                    const BaselineValues& values,
                                    std::uint64_t seed,
                                    double accuracy_confidence,
                                    std::shared_ptr<const Training> training);

Expected<std::shared_ptr<const Training>> train_dscp(const TrainingInput& input);

}  // namespace rayloc
