// A LinkTrace as arrays of numpy: `rayloc trace --out x.npz`.
#pragma once

#include <string>

#include "daemon/lab/trace/trace_link.h"
#include "engine/base/expected.h"
#include "engine/scene/scene.h"

namespace rayloc {

// a, tau [s], angles [rad] (theta_t, phi_t, theta_r, phi_r), interactions,
// objects and vertices [m], whose interaction axis precedes the path axis:
// letters of `kinds`, 0 behind the last. With a channel: frequencies [Hz]
// and cfr; with derivatives: gradient and gradient_names.
Expected<void> write_npz(const LinkTrace& traced, const Scene& scene, const std::string& path);

}  // namespace rayloc
