// CsiReceiver: converts datagrams of one access point to CsiFrames: recognises, decodes, assembles,
// normalises, and counts every datagram exactly once. A datagram that carries a whole frame
// (capture/decode/frame_decoder.h) is neither assembled nor normalised.
//
//   CsiReceiver receiver(options);
//   receiver.push(datagram, frames);        // appends the newly completed frames
//   receiver.advance(watermark, frames);    // appends the partial frames that timed out
//   receiver.flush(frames);                 // at the end of the input: all remaining frames
//
// Datagrams of another channel than the site's, and of a source that receives several access
// points, are rejected if the options request it: their CSI would be located without an error, and
// the position would be wrong.
//
// The frames are a function of the datagrams and their times alone. `advance` may be called at any
// rate, or only implicitly through push(), which advances to the datagram's time. Thread safety:
// one thread; counters() is a copy for that thread.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "capture/transport/datagram.h"
#include "engine/channel/csi_frame.h"
#include "engine/channel/radio_channel.h"

namespace rayloc {

struct DecoderRow;

struct CsiReceiverOptions {
  std::size_t access_point = 0;  // CsiFrame::access_point of its frames
  // Name of a wire format ("axcsi-v4"), or empty: detected for each datagram (WIRE_FORMATS 1.8).
  std::string format;
  // Receive chains that a complete frame must have, besides those learned from recent traffic.
  std::vector<std::uint8_t> expected_rx_chains;
  // A frame that is still partial this long after its first datagram is emitted as partial.
  Duration assembly_timeout = std::chrono::milliseconds(20);
  // Maximum number of frames being assembled; beyond it the oldest is emitted as partial.
  std::size_t max_pending = 256;
  // Reject frames whose transmitter address no device has: a group address (broadcast is one), or
  // zero if the format always has an address. Those of `stated_transmitters` are accepted
  // nevertheless.
  bool only_devices = false;
  std::vector<MacAddress> stated_transmitters;
  // Leave the CSI in FFT order with rotation and unusable tones, as on the wire (frames --raw).
  bool raw = false;
  // The site's channel: a datagram that states another one is rejected. Empty: every channel.
  std::optional<RadioChannel> channel;
  // Accept the other channels of its band and width as well, for a method that separates frames by
  // CsiFrame::channel.
  bool accepts_hops = false;
  // Reject datagrams of a source that receives several access points (mixture_detector.h). A second
  // one is detected with its first frames, so frames are held back for `settle` after the first
  // datagram and after each jump of the frame counter.
  bool reject_mixture = false;
  Duration settle{};
  // Accepts all CSI, for callers that locate nothing.
  void accept_every_source() {
    channel.reset();
    reject_mixture = false;
  }
};

// One change of the channel that the datagrams state.
struct ChannelChange {
  Timestamp time;
  RadioChannel from;
  RadioChannel to;
};

// received = sum(rejected) + duplicates + late + in_frames + in_flight, at every instant.
struct CsiReceiverCounters {
  std::uint64_t received = 0;                     // datagrams passed to push()
  std::map<std::string, std::uint64_t> rejected;  // datagrams by reason: "too_short", ...
  std::uint64_t duplicates = 0;                   // repeated fragments
  std::uint64_t late = 0;                         // datagrams whose frame had been emitted
  std::uint64_t in_frames = 0;                    // datagrams of emitted frames
  std::uint64_t in_flight = 0;                    // datagrams of frames being assembled
  std::uint64_t frames = 0;                       // emitted frames, including partial ones
  std::uint64_t partial = 0;
  // Emitted frames that lack an expected core, or hold no data of it, by core.
  std::map<std::uint8_t, std::uint64_t> without_rx_chain;

  // The channel that the latest datagram states, and the number of changes: an accepted hop is not
  // a change.
  std::optional<RadioChannel> channel;
  std::uint64_t channel_changes = 0;
  std::vector<ChannelChange> first_changes;  // at most kListedChanges
  static constexpr std::size_t kListedChanges = 4;
  // With CsiReceiverOptions::accepts_hops: the datagrams of each accepted channel.
  std::map<RadioChannel, std::uint64_t> hops;
  // The reason for which datagrams are currently rejected, for an operator: another channel, or
  // several access points. Empty if none are. `troubles` lists each reason so far, once.
  std::string trouble;
  std::vector<std::string> troubles;
};

class CsiReceiver {
 public:
  explicit CsiReceiver(CsiReceiverOptions options);
  // Uses these wire formats instead of decoder_rows().
  CsiReceiver(CsiReceiverOptions options, std::span<const DecoderRow> formats);
  ~CsiReceiver();
  CsiReceiver(CsiReceiver&&) noexcept;
  CsiReceiver& operator=(CsiReceiver&&) noexcept;

  void push(const Datagram& datagram, std::vector<CsiFrame>& out);
  void advance(Timestamp watermark, std::vector<CsiFrame>& out);
  void flush(std::vector<CsiFrame>& out);

  // Lower bound for the `time` of every frame emitted later, provided that no datagram before
  // `watermark` is pushed any more.
  Timestamp safe_time(Timestamp watermark) const;

  CsiReceiverCounters counters() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rayloc
