// The types of IFC 2x3 (ISO/PAS 16739).
#pragma once

#include <string_view>

namespace rayloc {

// `type` in capitals: "IFCWALL". Thread-safe.
bool is_ifc2x3_type(std::string_view type);

}  // namespace rayloc
