// Advice for an operator on the reasons for which datagrams of a source are rejected.
#pragma once

#include <string_view>

namespace rayloc {

// `reason`: a name of SourceCounters.rejected. Empty if there is no advice.
std::string_view source_advice(std::string_view reason);

}  // namespace rayloc
