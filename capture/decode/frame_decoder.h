// FrameDecoder: converts the payload of one datagram to a whole CSI frame, for extractors that send
// one datagram per frame.
//
// It returns the frame in the convention of the engine (engine/channel/csi_frame.h) and sets
// `complete` if no part is missing; CsiReceiver fills in `time`, `time_last` and
// `access_point`. It performs the checks of CsiDecoder in the same order, and keeps no state
// between datagrams.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include <tl/expected.hpp>

#include "capture/decode/csi_decoder.h"
#include "engine/channel/csi_frame.h"

namespace rayloc {

using FrameResult = tl::expected<CsiFrame, RejectReason>;

class FrameDecoder {
 public:
  FrameDecoder() = default;
  FrameDecoder(const FrameDecoder&) = delete;
  FrameDecoder& operator=(const FrameDecoder&) = delete;
  virtual ~FrameDecoder() = default;

  virtual std::string_view format() const = 0;  // static storage
  virtual FrameResult decode(std::span<const std::byte> payload) const = 0;
};

}  // namespace rayloc
