// Exit statuses of our programs (INTERFACE 1): those of sysexits.h that apply.
#pragma once

#include "engine/base/expected.h"

namespace rayloc {

constexpr int kExitUsage = 64;
constexpr int kExitInternal = 70;
// In addition to sysexits.h: the run was completed, and a calibration is no success.
constexpr int kExitUnexplained = 79;

constexpr int exit_status(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::kUsage:
      return kExitUsage;
    case ErrorKind::kBadInput:
      return 65;
    case ErrorKind::kUnavailable:
      return 69;
    case ErrorKind::kInternal:
      return kExitInternal;
    case ErrorKind::kConfiguration:
      return 78;
  }
  return kExitInternal;
}

}  // namespace rayloc
