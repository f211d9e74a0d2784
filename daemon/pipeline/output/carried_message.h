// Carried as the public message (proto/rayloc/v1/carried.proto). Both functions depend on their
// argument alone: the same value gives the same bytes, and the bytes give the value.
#pragma once

#include "daemon/pipeline/warm/carried.h"
#include "engine/base/expected.h"
#include "rayloc/v1/carried.pb.h"

namespace rayloc {

v1::Carried carried_message(const Carried& carried);

// Returns an Error (kBadInput) that describes a contradiction in the message.
Expected<Carried> carried_of(const v1::Carried& message);

}  // namespace rayloc
