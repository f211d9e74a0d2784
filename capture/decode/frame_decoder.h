// FrameDecoder: from the payload of one datagram to a whole CSI frame, for extractors that need no
// more than one datagram a frame.
//
// It gives the frame in the convention of the engine (engine/channel/csi_frame.h) and says in
// `complete` whether it has all that it should; CsiReceiver fills in `time`, `time_last` and
// `access_point`. It tests what CsiDecoder tests, in the same order, and keeps nothing between
// datagrams.
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
