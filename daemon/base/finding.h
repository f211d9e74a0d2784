// Finding: a result of a check for `rayloc doctor`: a fault with its remedy, or its absence.
#pragma once

#include <string>
#include <utility>

namespace rayloc {

struct Finding {
  enum class Kind { kOk, kWarning, kProblem };
  Kind kind = Kind::kOk;
  std::string what;
  std::string advice;  // remedy; empty when there is no fault

  static Finding ok(std::string what) { return {Kind::kOk, std::move(what), ""}; }
  static Finding warning(std::string what, std::string advice) {
    return {Kind::kWarning, std::move(what), std::move(advice)};
  }
  static Finding problem(std::string what, std::string advice = "") {
    return {Kind::kProblem, std::move(what), std::move(advice)};
  }
};

}  // namespace rayloc
