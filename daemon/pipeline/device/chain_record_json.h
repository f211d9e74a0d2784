// Evidence on receive chains that are being learned, as JSON: a part of the chain file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "engine/base/expected.h"
#include "engine/base/timestamp.h"
#include "engine/chains/chain_record.h"
#include "engine/room/room_model.h"

namespace rayloc {

// Limits of numbers in the file: arithmetic with them does not overflow.
inline constexpr double kMaxChainSigma = 10.0;  // [rad], chosen: nothing is known of the phase
inline constexpr std::uint64_t kMaxChainCount = 1'000'000'000;  // chosen: far above any count

// An Error names `key` if its value is not an integer of 0 to kMaxChainCount, or not a time [ns] of
// at most 4e18 in either direction.
Expected<std::size_t> chain_count_from_json(const nlohmann::ordered_json& json,
                                            const std::string& key);
Expected<Timestamp> chain_time_from_json(const nlohmann::ordered_json& json,
                                         const std::string& key);

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
