// DecoderRegistry: lists the wire formats and selects the format of a datagram.
//
// Without a fixed format every datagram is recognised separately, by magic number, length and the
// ranges of its fields (WIRE_FORMATS 1.8), so formats may be mixed in one recording.
#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "capture/decode/decoder_row.h"

namespace rayloc {

// All supported formats.
std::span<const DecoderRow> decoder_rows();

// Their names, in alphabetical order: "axcsi-v4", "intel-5300", "nexmon-v1", "nexmon-v2",
// "ubilocate". A site file may state any of them.
std::span<const std::string_view> wire_formats();
bool is_wire_format(std::string_view name);

class DecoderRegistry {
 public:
  // `format` is the name of one of the rows, or empty: detected. REQUIRES one of these.
  explicit DecoderRegistry(std::string_view format,
                           std::span<const DecoderRow> rows = decoder_rows());

  // The decoder of a datagram that carries a whole frame; null for one that decode() accepts.
  const FrameDecoder* frame_decoder(std::span<const std::byte> payload) const;

  DecodeResult decode(std::span<const std::byte> payload) const;

 private:
  template <typename Decoder>
  struct Known {
    bool (*resembles)(std::span<const std::byte> payload);
    std::unique_ptr<Decoder> decoder;
  };

  bool fixed_;  // the list below holds one decoder, which is used for every datagram
  std::vector<Known<FrameDecoder>> frames_;
  std::vector<Known<CsiDecoder>> fragments_;
};

}  // namespace rayloc
