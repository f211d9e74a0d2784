// What is asked of the playback of recordings over HTTP: POST /api/v1/playback?KEY=VALUE&...
//
//   state=playing|paused   playing at the end begins anew
//   speed=N|max            recorded seconds per second, from 0.001 on; max: as fast as it goes
//   position=SECONDS       after the beginning of the recordings; past their end: the end
#pragma once

#include "daemon/http/http_server.h"
#include "daemon/pipeline/playback/playback.h"
#include "engine/base/expected.h"

namespace rayloc {

// kUsage, with what to write instead, for an unknown key, a value that is none, a key that is there
// twice, or when nothing is asked for. `now`: before the change.
Expected<Playback::Change> playback_change(const HttpParameters& parameters,
                                           const Playback::State& now);

}  // namespace rayloc
