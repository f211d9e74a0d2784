// Evidence on receive chains that are being learned, as JSON: a part of the chain file.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "engine/base/expected.h"
#include "engine/chains/chain_record.h"
#include "engine/room/room_model.h"

namespace rayloc {

// Arrays of the burst are base64 text of float32 (`h`, real and imaginary parts) and of bytes
// (`weights`, tenths of a neper below the likeliest cell); `belief` is of float64, all in the
// byte order of this machine.
nlohmann::ordered_json to_json(const ChainRecord& record);

// An Error names the wrong key, below `place`, the keys that lead to `json`.
Expected<ChainRecord> record_from_json(const nlohmann::ordered_json& json,
                                       const std::string& place,
                                       const RoomModel& room,
                                       std::size_t access_point);

}  // namespace rayloc
