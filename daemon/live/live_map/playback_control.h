// Requests for the playback of recordings over HTTP: POST /api/v1/playback?KEY=VALUE&...
//
//   state=playing|paused   playing at the end restarts from the beginning
//   speed=N|max            recorded seconds per second, from 0.001 on; max: unlimited
//   position=SECONDS       after the beginning of the recordings; past their end: the end
#pragma once

#include "daemon/live/http/http_server.h"
#include "daemon/pipeline/playback/playback.h"
#include "engine/base/expected.h"

namespace rayloc {

// kUsage, with the valid values, for an unknown key, an invalid value, a repeated key, or an empty
// request. `now`: state before the change.
Expected<Playback::Change> playback_change(const HttpParameters& parameters,
                                           const Playback::State& now);

}  // namespace rayloc
