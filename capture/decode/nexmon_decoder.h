// nexmon_csi, "nexmon-v1" and "nexmon-v2": the extractor for bcm4339, bcm43455c0, bcm4358 and
// bcm4366c0.
//
// Version 2 added the RSSI and the frame control byte, and overwrites three CSI words of each
// datagram with the PhyRxStatus; both headers have 18 bytes. Neither has a frame counter.
#pragma once

#include "capture/decode/csi_decoder.h"

namespace rayloc {

enum class NexmonVersion { kV1, kV2 };

class NexmonDecoder final : public CsiDecoder {
 public:
  explicit NexmonDecoder(NexmonVersion version) : version_(version) {}

  std::string_view format() const override {
    return version_ == NexmonVersion::kV1 ? "nexmon-v1" : "nexmon-v2";
  }
  DecodeResult decode(std::span<const std::byte> payload) const override;

 private:
  NexmonVersion version_;
};

// True if magic number and length are those of nexmon, of either version.
bool resembles_nexmon(std::span<const std::byte> payload);
// The version that bytes 2 and 3 indicate. REQUIRES: resembles_nexmon(payload).
NexmonVersion nexmon_version(std::span<const std::byte> payload);

}  // namespace rayloc
