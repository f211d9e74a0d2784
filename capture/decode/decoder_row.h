// DecoderRow: one wire format. A row is defined beside its decoder; decoder_registry.cpp lists them
// all.
#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <variant>

#include "capture/decode/csi_decoder.h"
#include "capture/decode/frame_decoder.h"

namespace rayloc {

// A decoder of fragments, which are assembled, or of whole frames, which bypass the assembler.
using AnyDecoder = std::variant<std::unique_ptr<CsiDecoder>, std::unique_ptr<FrameDecoder>>;

struct DecoderRow {
  std::string_view name;  // name in a site file; the `format` of its fragments or frames
  // True if magic number, length and the fields with few legal values match this format. Rows are
  // tested in the order of the table, those of whole frames first.
  bool (*resembles)(std::span<const std::byte> payload) = nullptr;
  AnyDecoder (*make)() = nullptr;
};

extern const DecoderRow kIntel5300Row;  // intel5300_decoder.cpp
extern const DecoderRow kNexmonV1Row;   // nexmon_decoder.cpp
extern const DecoderRow kNexmonV2Row;   // nexmon_decoder.cpp
extern const DecoderRow kUbilocateRow;  // ubilocate_decoder.cpp
extern const DecoderRow kAxcsiRow;      // axcsi_decoder.cpp

}  // namespace rayloc
