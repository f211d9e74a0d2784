// [curve] of the configuration as the guard of our ZeroMQ sockets.
#pragma once

#include <functional>
#include <memory>

#include "daemon/config/config.h"
#include "daemon/log/limited_log.h"
#include "daemon/publish/socket/connection_guard.h"
#include "engine/base/expected.h"

namespace rayloc {

// Reads the secret key; says the public one, and later each client that is turned away, in `log`.
// kConfiguration when there is no secret key, or others may read it.
// `on_round`: ConnectionGuard::Options::on_round.
Expected<std::shared_ptr<ConnectionGuard>> open_curve_access(const CurveConfig& config,
                                                             std::shared_ptr<LimitedLog> log,
                                                             std::function<void()> on_round);

}  // namespace rayloc
