// Recent places of all targets, as JSON for the map (daemon/live/http/ROUTES.md,
// "/api/v1/presence").
#pragma once

#include <string>

#include "daemon/live/publish/message_board.h"
#include "engine/base/timestamp.h"

namespace rayloc {

std::string map_presence_json(const MessageBoard& board, Timestamp now);

}  // namespace rayloc
