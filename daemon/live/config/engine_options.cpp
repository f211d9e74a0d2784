#include "daemon/live/config/engine_options.h"

#include "daemon/methods/method.h"
#include "daemon/methods/track_options.h"

namespace rayloc {

MethodOptions engine_options(const Method& method, const EngineConfig& engine) {
  MethodOptions options;
  options.accuracy_confidence = engine.accuracy_confidence;
  if (method.has_setting(kTracksSetting)) {
    options.values.insert_or_assign(std::string(kTracksSetting), engine.tracks);
  }
  return options;
}

}  // namespace rayloc
