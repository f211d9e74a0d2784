// The part that all fuzz targets of decoders share: gives the bytes to the decoder, and checks
// accepted ones against the decoder's contract (csi_decoder.h).
#pragma once

#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "capture/decode/csi_decoder.h"
#include "capture/decode/frame_decoder.h"
#include "engine/base/check.h"

namespace rayloc::fuzz {

inline void check_decoder(const CsiDecoder& decoder, std::span<const std::uint8_t> input) {
  const std::span<const std::byte> payload = std::as_bytes(input);
  const DecodeResult result = decoder.decode(payload);
  if (!result) {
    RAYLOC_CHECK(!to_string(result.error()).empty());
    return;
  }
  RAYLOC_CHECK(result->format == decoder.format());
  RAYLOC_CHECK(result->rx_chain < kMaxRxChains && result->stream < kMaxStreams);
  RAYLOC_CHECK(result->tones > 0 && result->total_tones <= kMaxTones);
  RAYLOC_CHECK(result->first_tone + result->tones <= result->total_tones);
  RAYLOC_CHECK(result->first_tone % kToneBlock == 0 && result->tones % kToneBlock == 0);
  RAYLOC_CHECK(result->words.size() == kBytesPerWord * result->tones);
  RAYLOC_CHECK(result->words.data() >= payload.data() &&
               result->words.data() + result->words.size() <= payload.data() + payload.size());
  const int bandwidth = result->channel_bandwidth_mhz;
  RAYLOC_CHECK(bandwidth == 20 || bandwidth == 40 || bandwidth == 80 || bandwidth == 160);
  std::vector<std::complex<float>> csi(result->tones);
  unpack_csi_words(result->layout, result->words, csi);
  for (const std::complex<float> h : csi) {
    RAYLOC_CHECK(std::isfinite(std::norm(h)));
  }
}

inline void check_decoder(const FrameDecoder& decoder, std::span<const std::uint8_t> input) {
  const FrameResult result = decoder.decode(std::as_bytes(input));
  if (!result) {
    RAYLOC_CHECK(!to_string(result.error()).empty());
    return;
  }
  RAYLOC_CHECK(result->format == decoder.format());
  RAYLOC_CHECK(!result->rx_chains.empty() && result->rx_chains.size() <= kMaxRxChains);
  RAYLOC_CHECK(result->power_dbm.size() == result->rx_chains.size());
  RAYLOC_CHECK(result->csi.antennas() == result->rx_chains.size());
  RAYLOC_CHECK(result->csi.tones() == result->tone_index.size());
  for (const std::complex<float> h : result->csi.values()) {
    RAYLOC_CHECK(std::isfinite(std::norm(h)));
  }
}

}  // namespace rayloc::fuzz
