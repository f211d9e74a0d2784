// A fitted number, with what was assumed before and how sure the fit is.
#pragma once

namespace rayloc {

template <typename Value>
struct Fitted {
  Value value{};
  Value prior{};  // what the floor plan, the survey or the table said
  Value sigma{};  // posterior standard deviation; 0: the data do not bound it
};

}  // namespace rayloc
