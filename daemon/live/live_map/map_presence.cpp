#include "daemon/live/live_map/map_presence.h"

#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

namespace rayloc {

std::string map_presence_json(const MessageBoard& board, Timestamp now) {
  const MessageBoard::PresenceNow presence = board.presence(now);
  auto cells = nlohmann::ordered_json::array();
  for (const Presence::Cell& one : presence.cells) {
    cells.push_back({one.x, one.y, std::round(10.0 * one.seconds) / 10.0});
  }
  const nlohmann::ordered_json json = {{"cell_m", Presence::kCell},
                                       {"kept_s", to_seconds(presence.kept)},
                                       {"left_out", presence.left_out},
                                       {"cells", std::move(cells)}};
  return json.dump() + "\n";
}

}  // namespace rayloc
