// [curve] of the configuration as the guard of raylocd's ZeroMQ sockets.
#pragma once

#include <functional>
#include <memory>

#include "daemon/live/config/config.h"
#include "daemon/live/log/limited_log.h"
#include "daemon/live/publish/socket/connection_guard.h"
#include "engine/base/expected.h"

namespace rayloc {

// Reads the secret key; writes the public one, and later each rejected client, to `log`.
// kConfiguration when there is no secret key, or others may read it.
// `on_round`: ConnectionGuard::Options::on_round.
Expected<std::shared_ptr<ConnectionGuard>> open_curve_access(const CurveConfig& config,
                                                             std::shared_ptr<LimitedLog> log,
                                                             std::function<void()> on_round);

}  // namespace rayloc
