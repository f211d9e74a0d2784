// DecoderRegistry: the wire formats there are, and which of them a datagram is in.
//
// Without a fixed format every datagram is recognised on its own, by magic number, length and the
// ranges of its fields (WIRE_FORMATS 1.8), so formats may be mixed in one recording.
#pragma once

#include <span>
#include <string_view>

#include "capture/decode/axcsi_decoder.h"
#include "capture/decode/csi_decoder.h"
#include "capture/decode/nexmon_decoder.h"
#include "capture/decode/ubilocate_decoder.h"

namespace rayloc {

// "axcsi-v4", "nexmon-v1", "nexmon-v2", "ubilocate": what a site file may name.
std::span<const std::string_view> wire_formats();
bool is_wire_format(std::string_view name);

class DecoderRegistry {
 public:
  // `format` is one of wire_formats(), or empty: recognised. REQUIRES one of these.
  explicit DecoderRegistry(std::string_view format);

  DecodeResult decode(std::span<const std::byte> payload) const;

 private:
  AxcsiDecoder axcsi_;
  NexmonDecoder nexmon_v1_{NexmonVersion::kV1};
  NexmonDecoder nexmon_v2_{NexmonVersion::kV2};
  UbilocateDecoder ubilocate_;
  const CsiDecoder* fixed_ = nullptr;  // one of the four, or none
};

}  // namespace rayloc
