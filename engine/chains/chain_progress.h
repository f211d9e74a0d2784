// progress_text: how far the learning of an access point's receive chains is, for people.
#pragma once

#include <string>

#include "engine/chains/chain_state.h"

namespace rayloc {

// "4 of at least 10 bursts", "12 bursts, evidence 3.1 of 7.0 for one state of the chains"
std::string progress_text(const ChainState& state);

}  // namespace rayloc
