// progress_text: progress of learning an access point's receive chains, as text for users.
#pragma once

#include <string>

#include "engine/chains/chain_state.h"

namespace rayloc {

// "4 of at least 10 bursts", "12 bursts, evidence 3.1 of 7.0 for one state of the chains"
std::string progress_text(const ChainState& state);

}  // namespace rayloc
