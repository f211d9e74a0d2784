#include "capture/decode/csi_decoder.h"

#include "engine/base/check.h"

namespace rayloc {

std::string_view to_string(RejectReason reason) {
  switch (reason) {
    case RejectReason::kTooShort:
      return "too_short";
    case RejectReason::kUnknownFormat:
      return "unknown_format";
    case RejectReason::kLengthMismatch:
      return "length_mismatch";
    case RejectReason::kBadMagic:
      return "bad_magic";
    case RejectReason::kWrongVersion:
      return "wrong_version";
    case RejectReason::kRxChainRange:
      return "core_range";
    case RejectReason::kStreamRange:
      return "stream_range";
    case RejectReason::kToneRange:
      return "tone_range";
    case RejectReason::kEncodingRange:
      return "encoding_range";
    case RejectReason::kHeaderMismatch:
      return "header_mismatch";
    case RejectReason::kAntennaPermutation:
      return "antenna_permutation";
    case RejectReason::kLegacyRate:
      return "legacy_rate";
    case RejectReason::kFrameMismatch:
      return "frame_mismatch";
    case RejectReason::kOtherChannel:
      return "other_channel";
    case RejectReason::kSeveralAccessPoints:
      return "several_access_points";
    case RejectReason::kGroupAddress:
      return "group_address";
    case RejectReason::kZeroAddress:
      return "zero_address";
  }
  RAYLOC_CHECK(false);
}

}  // namespace rayloc
