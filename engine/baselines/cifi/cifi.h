// CiFi: locates a device by images of phase differences between access points' antennas [CF].
//
// The published value of a tone is the angle asin(phase lambda / 2 pi d). At antenna distances
// above half a wavelength it is not a direction, and it jumps where the phase wraps; at smaller
// distances it is undefined for some phases. Ours are the cosine and the sine of the phase, which
// do not jump; `input=aoa` gives the published value, clipped to the range of an arcsine.
//
// References: [CF] X. Wang, X. Wang, S. Mao, CiFi, IEEE ICC 2017 and TNSE 2018.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "engine/base/expected.h"
#include "engine/baselines/places/place_classifier.h"
#include "engine/baselines/settings.h"
#include "engine/baselines/training.h"

namespace rayloc {

std::span<const BaselineSetting> cifi_settings();

// Uses the values of the training. Errors: as of PlaceClassifier, and if `values` states another
// image than the training.
Expected<PlaceClassifier> make_cifi(std::shared_ptr<const RoomModel> room,
                                    const BaselineValues& values,
                                    std::uint64_t seed,
                                    double accuracy_confidence,
                                    std::shared_ptr<const Training> training);

Expected<std::shared_ptr<const Training>> train_cifi(const TrainingInput& input);

}  // namespace rayloc
