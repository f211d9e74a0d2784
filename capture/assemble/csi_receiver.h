// CsiReceiver: datagrams of one access point in, CsiFrames out: recognise, decode, assemble,
// normalise, and count every datagram exactly once. A datagram that carries a whole frame
// (capture/decode/frame_decoder.h) is neither assembled nor normalised.
//
//   CsiReceiver receiver(options);
//   receiver.push(datagram, frames);        // appends the frames that became complete
//   receiver.advance(watermark, frames);    // appends the partial frames whose time is over
//   receiver.flush(frames);                 // at the end of the input: everything that is left
//
// Datagrams of another channel than the site's, and of a source that several access points send to,
// are rejected where the options ask for it: their CSI would be located without an error, and
// wrongly.
//
// The frames are a function of the datagrams and their times alone. `advance` may be called as
// often as one likes or only implicitly through push(), which advances to the datagram's time.
// Thread safety: one thread; counters() is a copy for that thread.
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
  int access_point = 0;
  // Name of a wire format ("axcsi-v4"), or empty: recognised by datagram (WIRE_FORMATS 1.8).
  std::string format;
  // Receive chains that a complete frame must have, besides those learned from the traffic itself.
  std::vector<std::uint8_t> expected_cores;
  // A frame that is still partial this long after its first datagram is emitted as it is.
  Duration assembly_timeout = std::chrono::milliseconds(20);
  // Frames being assembled at one time; past that the oldest is emitted as it is.
  std::size_t max_pending = 256;
  // Refuse frames whose transmitter's address no device has: a group address (broadcast is one), or
  // zero where the format always has an address. Those of `stated_transmitters` are taken all the
  // same.
  bool only_devices = false;
  std::vector<MacAddress> stated_transmitters;
  // Leave the CSI in FFT order with rotation and unusable tones, as on the wire (frames --raw).
  bool raw = false;
  // The site's channel: a datagram that states another one is rejected. Nothing: every channel.
  std::optional<RadioChannel> channel;
  // Accept the other channels of its band and width as well, for a method that separates frames by
  // CsiFrame::channel.
  bool accepts_hops = false;
  // Reject what several access points send to the one source (mixture_detector.h). A second one
  // shows itself with its first frames, so frames are held back for `settle` after the first
  // datagram and after each jump of the frame counter.
  bool reject_mixture = false;
  Duration settle{};
  // Where nothing is located and all CSI is wanted.
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
  std::uint64_t received = 0;                     // datagrams given to push()
  std::map<std::string, std::uint64_t> rejected;  // by the reason's name: "too_short", ...
  std::uint64_t duplicates = 0;                   // the same fragment again
  std::uint64_t late = 0;                         // its frame had been emitted
  std::uint64_t in_frames = 0;                    // part of an emitted frame
  std::uint64_t in_flight = 0;                    // part of a frame that is being assembled
  std::uint64_t frames = 0;                       // emitted, partial ones among them
  std::uint64_t partial = 0;
  // Of these, those that lack an expected core, or hold nothing of it.
  std::map<std::uint8_t, std::uint64_t> without_core;

  // The channel that the latest datagram states, and how often it changed: a hop that is accepted
  // is no change.
  std::optional<RadioChannel> channel;
  std::uint64_t channel_changes = 0;
  std::vector<ChannelChange> first_changes;  // at most kListedChanges
  static constexpr std::size_t kListedChanges = 4;
  // With CsiReceiverOptions::accepts_hops: the datagrams of each channel that is taken.
  std::map<RadioChannel, std::uint64_t> hops;
  // The reason why datagrams are rejected at present, for an operator: another channel, or several
  // access points. Empty where none is. `troubles` has each reason that there has been, once.
  std::string trouble;
  std::vector<std::string> troubles;
};

class CsiReceiver {
 public:
  explicit CsiReceiver(CsiReceiverOptions options);
  // With these wire formats instead of decoder_rows().
  CsiReceiver(CsiReceiverOptions options, std::span<const DecoderRow> formats);
  ~CsiReceiver();
  CsiReceiver(CsiReceiver&&) noexcept;
  CsiReceiver& operator=(CsiReceiver&&) noexcept;

  void push(const Datagram& datagram, std::vector<CsiFrame>& out);
  void advance(Timestamp watermark, std::vector<CsiFrame>& out);
  void flush(std::vector<CsiFrame>& out);

  // No frame emitted later will have an earlier `time` than this, given that no datagram before
  // `watermark` is pushed any more.
  Timestamp safe_time(Timestamp watermark) const;

  CsiReceiverCounters counters() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rayloc
