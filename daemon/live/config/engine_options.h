// The options that [engine] states for a method.
#pragma once

#include "daemon/live/config/config.h"
#include "daemon/methods/method_options.h"

namespace rayloc {

MethodOptions engine_options(const Method& method, const EngineConfig& engine);

}  // namespace rayloc
