// A fitted number, with its prior and the standard deviation of the fit.
#pragma once

namespace rayloc {

template <typename Value>
struct Fitted {
  Value value{};
  Value prior{};  // from the floor plan, the survey or the table
  Value sigma{};  // posterior standard deviation; 0: not bounded by the data
};

}  // namespace rayloc
