// Carried as the public message (proto/rayloc/v1/carried.proto). Both are functions of their
// argument: the same value gives the same bytes, and comes back.
#pragma once

#include "daemon/pipeline/warm/carried.h"
#include "engine/base/expected.h"
#include "rayloc/v1/carried.pb.h"

namespace rayloc {

v1::Carried carried_message(const Carried& carried);

// An Error (kBadInput) that says what of the message contradicts itself.
Expected<Carried> carried_of(const v1::Carried& message);

}  // namespace rayloc
