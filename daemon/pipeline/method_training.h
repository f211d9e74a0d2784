// Training data of a method for a site, for the code that creates the method.
#pragma once

#include <memory>
#include <string>

#include "daemon/methods/method.h"
#include "daemon/site/model/site.h"
#include "daemon/site/model/training_file.h"
#include "engine/base/expected.h"
#include "engine/room/room_model.h"

namespace rayloc {

// Null: no training exists, and the method can locate without. An Error (kConfiguration) that
// states the command to run, or one of load_training().
inline Expected<std::shared_ptr<const Training>> training_of(const Site& site,
                                                             const Method& method,
                                                             const RoomModel& room) {
  if (method.train == nullptr) {
    return nullptr;
  }
  const std::string name(method.name);
  auto training = load_training(site, name, room, method.baseline_settings);
  if (training && *training == nullptr && method.needs_training) {
    return make_error(ErrorKind::kConfiguration,
                      (site.directory / "site.toml").string() + ": no training of " + name +
                          ": run rayloc train " + site.directory.string() + " --method " + name +
                          " --capture ... --points ...");
  }
  return training;
}

}  // namespace rayloc
