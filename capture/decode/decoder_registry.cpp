#include "capture/decode/decoder_registry.h"

#include <algorithm>
#include <array>
#include <utility>

#include "capture/decode/axcsi_decoder.h"
#include "capture/decode/broadcom_header.h"
#include "engine/base/check.h"

namespace rayloc {
namespace {

// The reason for rejecting a datagram that resembles no format.
RejectReason unknown(std::span<const std::byte> payload) {
  if (payload.size() < kAxcsiHeaderBytes) {
    return RejectReason::kTooShort;
  }
  return has_nexmon_magic(payload) ? RejectReason::kLengthMismatch : RejectReason::kUnknownFormat;
}

}  // namespace

// AX-CSI has no magic number, and an address may begin with that of nexmon: it is tested last.
std::span<const DecoderRow> decoder_rows() {
  static const std::array kRows{
      kIntel5300Row, kNexmonV1Row, kNexmonV2Row, kUbilocateRow, kAxcsiRow};
  return kRows;
}

std::span<const std::string_view> wire_formats() {
  static const std::vector<std::string_view> kNames = [] {
    std::vector<std::string_view> names;
    for (const DecoderRow& row : decoder_rows()) {
      names.push_back(row.name);
    }
    std::sort(names.begin(), names.end());
    return names;
  }();
  return kNames;
}

bool is_wire_format(std::string_view name) {
  const std::span<const std::string_view> names = wire_formats();
  return std::find(names.begin(), names.end(), name) != names.end();
}

DecoderRegistry::DecoderRegistry(std::string_view format, std::span<const DecoderRow> rows)
    : fixed_(!format.empty()) {
  for (const DecoderRow& row : rows) {
    if (fixed_ && row.name != format) {
      continue;
    }
    AnyDecoder made = row.make();
    if (auto* whole = std::get_if<std::unique_ptr<FrameDecoder>>(&made)) {
      frames_.push_back({row.resembles, std::move(*whole)});
    } else {
      fragments_.push_back({row.resembles, std::get<std::unique_ptr<CsiDecoder>>(std::move(made))});
    }
  }
  RAYLOC_CHECK(!fixed_ || frames_.size() + fragments_.size() == 1);
}

const FrameDecoder* DecoderRegistry::frame_decoder(std::span<const std::byte> payload) const {
  for (const auto& known : frames_) {
    if (fixed_ || known.resembles(payload)) {
      return known.decoder.get();
    }
  }
  return nullptr;
}

DecodeResult DecoderRegistry::decode(std::span<const std::byte> payload) const {
  for (const auto& known : fragments_) {
    if (fixed_ || known.resembles(payload)) {
      return known.decoder->decode(payload);
    }
  }
  return tl::make_unexpected(unknown(payload));
}

}  // namespace rayloc
