#include "capture/decode/decoder_registry.h"

#include <algorithm>
#include <array>
#include <initializer_list>

#include "capture/decode/broadcom_header.h"
#include "engine/base/check.h"

namespace rayloc {
namespace {

constexpr std::array<std::string_view, 4> kWireFormats = {
    "axcsi-v4", "nexmon-v1", "nexmon-v2", "ubilocate"};

// Below this no format has a header.
constexpr std::size_t kShortestHeader = kNexmonHeaderBytes;

}  // namespace

std::span<const std::string_view> wire_formats() { return kWireFormats; }

bool is_wire_format(std::string_view name) {
  return std::find(kWireFormats.begin(), kWireFormats.end(), name) != kWireFormats.end();
}

DecoderRegistry::DecoderRegistry(std::string_view format) {
  RAYLOC_CHECK(format.empty() || is_wire_format(format));
  for (const CsiDecoder* decoder :
       std::initializer_list<const CsiDecoder*>{&axcsi_, &nexmon_v1_, &nexmon_v2_, &ubilocate_}) {
    if (decoder->format() == format) {
      fixed_ = decoder;
    }
  }
}

DecodeResult DecoderRegistry::decode(std::span<const std::byte> payload) const {
  if (fixed_ != nullptr) {
    return fixed_->decode(payload);
  }
  if (payload.size() < kShortestHeader) {
    return tl::make_unexpected(RejectReason::kTooShort);
  }
  if (resembles_nexmon(payload)) {
    return nexmon_version(payload) == NexmonVersion::kV1 ? nexmon_v1_.decode(payload)
                                                         : nexmon_v2_.decode(payload);
  }
  if (resembles_ubilocate(payload)) {
    return ubilocate_.decode(payload);
  }
  // No magic number of its own; an address may begin with that of nexmon.
  DecodeResult result = axcsi_.decode(payload);
  if (result || result.error() == RejectReason::kTooShort || resembles_axcsi(payload)) {
    return result;
  }
  if (has_nexmon_magic(payload)) {
    return tl::make_unexpected(RejectReason::kLengthMismatch);
  }
  return tl::make_unexpected(RejectReason::kUnknownFormat);
}

}  // namespace rayloc
