// The training file: the data that `rayloc train` learned for a method, as TOML, in the folder
// training/ of a site. It names its origin, and is valid for that calibration and radio only.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "daemon/site/model/site.h"
#include "engine/base/expected.h"
#include "engine/baselines/training.h"
#include "engine/room/room_model.h"

namespace rayloc {

// `content`: hash of the recordings and points used for training. The weights of a network are in a
// separate file beside it (weights_file.h), METHOD.f32.
std::string training_toml(const Training& training, const Site& site, const std::string& content);

// Reads the file that the site names for the method; null if it names none. An Error
// (kConfiguration) for a file that is damaged, of another method, calibration or radio, or whose
// weights are. Path-loss laws are valid for the transmitters whose power the site still states to
// be constant. `settings`: of the method.
Expected<std::shared_ptr<const Training>> load_training(const Site& site,
                                                        const std::string& method,
                                                        const RoomModel& room,
                                                        std::span<const BaselineSetting> settings);

}  // namespace rayloc
