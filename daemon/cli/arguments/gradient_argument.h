// `--gradient power:WHAT`: selects derivatives of the received power; WHAT as in
// parse_parameters().
#pragma once

#include <string>
#include <vector>

#include "daemon/lab/trace/named_parameters.h"
#include "engine/base/expected.h"
#include "engine/scene/scene.h"

namespace rayloc::cli {

// Errors (kUsage) name the option, the unknown name and the closest valid one.
Expected<std::vector<NamedParameter>> parse_gradient(const std::string& text, const Scene& scene);

}  // namespace rayloc::cli
