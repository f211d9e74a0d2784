// UbiLocate, "ubilocate": another extractor for bcm4366c0 access points (RT-AC86U). Its header
// states the expected cores and streams, and it has a frame counter.
#pragma once

#include "capture/decode/csi_decoder.h"

namespace rayloc {

class UbilocateDecoder final : public CsiDecoder {
 public:
  std::string_view format() const override { return "ubilocate"; }
  DecodeResult decode(std::span<const std::byte> payload) const override;
};

// True if magic number and length are those of UbiLocate.
bool resembles_ubilocate(std::span<const std::byte> payload);

}  // namespace rayloc
