// FrameNormalizer: converts an assembled frame in wire order to a CsiFrame in the engine's
// convention: tones ascending, 802.11 rotation undone, unusable tones left out.
//
// It leaves out the tones that the frame's format does not fill (null, DC, guard), those that the
// extractor overwrote, the pilots of VHT and HE frames of several streams (their training symbols
// do not separate the streams there [11ac 21.3.8.3.5]; on recordings such a pilot is 0.6 to 1.1 of
// its own size away from the mean of its neighbours, any other tone 0.03), and the tones that a HE
// frame with a short training field did not sound. The rotation is a multiple of 90 degrees:
// undoing it exchanges and negates parts, exactly.
//
// Flags: "retry" (same 802.11 sequence control as the previous frame), "subband" (fills a part of
// the channel), "missing_core" (an expected core or stream did not arrive), "missing_tones" (blocks
// of tones did not arrive; their rows are left out, or their tones if no row is whole), "zero_core"
// (a chain wrote zeros only), "sparse_training" (HE, every second or fourth tone sounded),
// "common_power" (`power_dbm` is one value for the whole frame).
//
// Thread safety: one thread; it caches the layout of the previous frame.
#pragma once

#include <cstdint>
#include <vector>

#include "capture/assemble/frame_assembler.h"
#include "capture/assemble/occupancy.h"
#include "engine/channel/csi_frame.h"

namespace rayloc {

class FrameNormalizer {
 public:
  // raw: keeps FFT order, rotation and unusable tones; tone_index is then in the order of the wire.
  FrameNormalizer(std::size_t access_point, bool raw) : access_point_(access_point), raw_(raw) {}

  CsiFrame normalize(const AssembledFrame& assembled);

 private:
  // The properties of a frame that determine which tones are read from where.
  struct Layout {
    PhyFormat phy = PhyFormat::kLegacy;
    Occupancy occupancy;
    int total_tones = 0;
    bool without_pilots = false;
    int stride = 1;  // spacing of the sounded tones
    std::uint16_t overwritten_first = 0;
    std::uint16_t overwritten_count = 0;
    bool raw = false;
    std::uint32_t coverage = 0;  // received blocks of kToneBlock tones on the wire

    friend bool operator==(const Layout&, const Layout&) = default;
  };
  // `count` adjacent tones on the wire with the same rotation.
  struct Run {
    std::size_t wire_begin = 0;
    std::size_t count = 0;
    std::uint8_t quarter_turns = 0;
  };
  // The tones of one layout, ascending.
  struct Selection {
    Layout layout;
    std::vector<std::int16_t> tone_index;
    std::vector<Run> runs;
  };
  static constexpr std::size_t kMaxSelections = 16;

  Layout layout_of(const AssembledFrame& assembled,
                   const std::vector<std::uint8_t>& rows,
                   std::uint32_t coverage) const;
  const Selection& selection_for(const Layout& layout);
  static Selection make_selection(const Layout& layout);
  static Selection make_raw_selection(const Layout& layout);

  std::size_t access_point_;
  bool raw_;
  std::vector<Selection> selections_;
  std::size_t current_ = 0;
};

}  // namespace rayloc
