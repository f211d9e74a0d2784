#include "capture/assemble/frame_normalizer.h"

#include <algorithm>
#include <array>

#include "engine/base/check.h"
#include "engine/channel/tone_plan.h"

namespace rayloc {
namespace {

// Rows of the frame that are copied to the CsiFrame, in its order: [rx_chain][stream].
struct RowSelection {
  std::vector<std::uint8_t> rx_chains;
  std::vector<std::uint8_t> slots;
  std::size_t streams = 0;
  std::uint32_t coverage = 0;  // blocks received in all of `slots`
};

// The largest rectangle of cores x streams among `slots`: every core that has all received streams;
// without such a core, the streams of the first core and the cores that have them.
RowSelection rectangle_of(unsigned slots) {
  constexpr unsigned kStreamMask = (1U << kMaxStreams) - 1U;
  std::array<unsigned, kMaxRxChains> streams_of{};
  unsigned streams = 0;
  for (std::size_t rx_chain = 0; rx_chain < kMaxRxChains; ++rx_chain) {
    streams_of[rx_chain] = (slots >> slot_of(rx_chain, 0)) & kStreamMask;
    streams |= streams_of[rx_chain];
  }
  const auto has_all = [&streams](unsigned mask) { return (mask & streams) == streams; };
  if (std::none_of(streams_of.begin(), streams_of.end(), has_all)) {
    streams = *std::find_if(
        streams_of.begin(), streams_of.end(), [](unsigned mask) { return mask != 0; });
  }
  RowSelection selection;
  for (std::size_t rx_chain = 0; rx_chain < kMaxRxChains; ++rx_chain) {
    if (!has_all(streams_of[rx_chain])) {
      continue;
    }
    selection.rx_chains.push_back(static_cast<std::uint8_t>(rx_chain));
    for (std::size_t stream = 0; stream < kMaxStreams; ++stream) {
      if (((streams >> stream) & 1U) != 0) {
        selection.slots.push_back(static_cast<std::uint8_t>(slot_of(rx_chain, stream)));
      }
    }
  }
  selection.streams = selection.slots.size() / selection.rx_chains.size();
  return selection;
}

RowSelection select_rows(const AssembledFrame& assembled) {
  unsigned whole = 0;
  std::uint32_t common = assembled.full_coverage();
  std::size_t fullest = 0;
  for (std::size_t slot = 0; slot < kMaxSlots; ++slot) {
    if (assembled.has_slot(slot)) {
      whole |= assembled.is_whole(slot) ? 1U << slot : 0U;
      common &= assembled.coverage[slot];
      const auto blocks = [&](std::size_t s) { return __builtin_popcount(assembled.coverage[s]); };
      fullest = blocks(slot) > blocks(fullest) ? slot : fullest;
    }
  }
  RowSelection selection;
  if (whole != 0) {
    selection = rectangle_of(whole);
    selection.coverage = assembled.full_coverage();
  } else if (common != 0) {
    selection = rectangle_of(assembled.slots);
    selection.coverage = common;
  } else {
    selection = rectangle_of(1U << fullest);
    selection.coverage = assembled.coverage[fullest];
  }
  return selection;
}

// h -> h * j^-quarter_turns.
std::complex<float> derotated(std::complex<float> h, unsigned quarter_turns) {
  switch (quarter_turns) {
    case 1:
      return {h.imag(), -h.real()};
    case 2:
      return {-h.real(), -h.imag()};
    case 3:
      return {-h.imag(), h.real()};
    default:
      return h;
  }
}

bool is_zero(std::span<const std::complex<float>> row) {
  return std::all_of(
      row.begin(), row.end(), [](std::complex<float> h) { return h == std::complex<float>(); });
}

// HE frames may sound every second or fourth tone only (2x, 1x HE-LTF); the others then have far
// less power. The stride is counted from the centre.
int training_stride(const AssembledFrame& assembled,
                    const std::vector<std::uint8_t>& rows,
                    const Occupancy& occupancy) {
  std::array<double, 4> power{};
  for (const std::uint8_t slot : rows) {
    const auto row = assembled.row(slot);
    for (const std::int16_t tone : tone_plan(PhyFormat::kHe, occupancy.bandwidth_mhz).active) {
      const auto index = wire_index(tone + occupancy.centre_tone,
                                    assembled.header.total_tones,
                                    /*high_efficiency=*/true);
      power[static_cast<std::size_t>(tone) & 3U] += static_cast<double>(std::norm(row[index]));
    }
  }
  constexpr double kSilent = 0.03;  // -15 dB
  const bool odd_silent = power[1] + power[3] < kSilent * (power[0] + power[2]);
  if (!odd_silent) {
    return 1;
  }
  return power[2] < kSilent * power[0] ? 4 : 2;
}

void set_flags(const AssembledFrame& assembled, const RowSelection& rows, CsiFrame& frame) {
  if (assembled.retry) {
    frame.flags.emplace_back("retry");
  }
  if (frame.bandwidth_mhz != frame.channel_bandwidth_mhz) {
    frame.flags.emplace_back("subband");
  }
  if (assembled.missing_slots != 0) {
    frame.flags.emplace_back("missing_core");
  }
  if (!assembled.is_rectangular()) {
    frame.flags.emplace_back("missing_tones");
  }
  if (std::any_of(rows.slots.begin(), rows.slots.end(), [&](std::uint8_t slot) {
        return is_zero(assembled.row(slot));
      })) {
    frame.flags.emplace_back("zero_core");
  }
}

}  // namespace

FrameNormalizer::Layout FrameNormalizer::layout_of(const AssembledFrame& assembled,
                                                   const std::vector<std::uint8_t>& rows,
                                                   std::uint32_t coverage) const {
  const CsiFragment& header = assembled.header;
  Layout layout;
  layout.total_tones = header.total_tones;
  layout.coverage = coverage;
  layout.overwritten_first = header.overwritten_first;
  layout.overwritten_count = header.overwritten_count;
  layout.raw = raw_;
  layout.occupancy = {header.channel_bandwidth_mhz, 0};
  layout.phy = header.phy.value_or(PhyFormat::kVht);
  if (coverage != assembled.full_coverage()) {
    return layout;  // too little data to decide
  }
  layout.occupancy = find_occupancy(assembled, rows);
  if (!header.phy && has_legacy_tones(assembled, rows, layout.occupancy)) {
    layout.phy = PhyFormat::kLegacy;
  }
  if (layout.phy == PhyFormat::kHe) {
    layout.stride = training_stride(assembled, rows, layout.occupancy);
  }
  return layout;
}

FrameNormalizer::Selection FrameNormalizer::make_raw_selection(const Layout& layout) {
  Selection selection;
  selection.layout = layout;
  const bool he = layout.phy == PhyFormat::kHe;
  std::vector<std::int16_t> tone_at(static_cast<std::size_t>(layout.total_tones));
  for (int tone = -layout.total_tones / 2; tone < layout.total_tones / 2; ++tone) {
    tone_at[wire_index(tone, layout.total_tones, he)] = static_cast<std::int16_t>(tone);
  }
  for (std::size_t i = 0; i < tone_at.size(); ++i) {
    if (((layout.coverage >> (i / kToneBlock)) & 1U) != 0) {
      selection.tone_index.push_back(tone_at[i]);
      selection.runs.push_back({i, 1, 0});
    }
  }
  return selection;
}

FrameNormalizer::Selection FrameNormalizer::make_selection(const Layout& layout) {
  Selection selection;
  selection.layout = layout;
  const TonePlan& plan = tone_plan(layout.phy, layout.occupancy.bandwidth_mhz);
  for (std::size_t i = 0; i < plan.active.size(); ++i) {
    const int tone = plan.active[i];
    const int channel_tone = tone + layout.occupancy.centre_tone;
    const std::size_t index =
        wire_index(channel_tone, layout.total_tones, layout.phy == PhyFormat::kHe);
    const bool unusable =
        (layout.without_pilots &&
         std::binary_search(plan.pilots.begin(), plan.pilots.end(), plan.active[i])) ||
        tone % layout.stride != 0 || index - layout.overwritten_first < layout.overwritten_count ||
        ((layout.coverage >> (index / kToneBlock)) & 1U) == 0;
    if (unusable) {
      continue;
    }
    const std::uint8_t turns = plan.quarter_turns[i];
    auto& runs = selection.runs;
    if (!runs.empty() && runs.back().wire_begin + runs.back().count == index &&
        runs.back().quarter_turns == turns) {
      ++runs.back().count;
    } else {
      runs.push_back({index, 1, turns});
    }
    selection.tone_index.push_back(static_cast<std::int16_t>(channel_tone));
  }
  return selection;
}

const FrameNormalizer::Selection& FrameNormalizer::selection_for(const Layout& layout) {
  if (current_ < selections_.size() && selections_[current_].layout == layout) {
    return selections_[current_];
  }
  const auto found = std::find_if(selections_.begin(),
                                  selections_.end(),
                                  [&layout](const Selection& s) { return s.layout == layout; });
  if (found != selections_.end()) {
    current_ = static_cast<std::size_t>(found - selections_.begin());
    return *found;
  }
  if (selections_.size() < kMaxSelections) {
    selections_.emplace_back();
    current_ = selections_.size() - 1;
  } else {
    current_ = (current_ + 1) % kMaxSelections;
  }
  selections_[current_] = layout.raw ? make_raw_selection(layout) : make_selection(layout);
  return selections_[current_];
}

CsiFrame FrameNormalizer::normalize(const AssembledFrame& assembled) {
  const CsiFragment& header = assembled.header;
  const RowSelection rows = select_rows(assembled);
  Layout layout = layout_of(assembled, rows.slots, rows.coverage);

  CsiFrame frame;
  frame.time = assembled.time;
  frame.time_last = assembled.time_last;
  frame.access_point = access_point_;
  frame.transmitter = header.transmitter;
  frame.format = header.format;
  frame.phy = layout.phy;
  frame.bandwidth_mhz = layout.occupancy.bandwidth_mhz;
  frame.channel_bandwidth_mhz = header.channel_bandwidth_mhz;
  frame.channel = header.channel;
  frame.sequence = header.sequence;
  frame.sequence_control = header.sequence_control;
  frame.transmitted_streams = header.transmitted_streams;
  if (frame.transmitted_streams == 0) {
    frame.transmitted_streams = static_cast<int>(rows.slots.back() % kMaxStreams) + 1;
  }
  layout.without_pilots = frame.transmitted_streams > 1 &&
                          (layout.phy == PhyFormat::kVht || layout.phy == PhyFormat::kHe);
  frame.tone_spacing_hz = tone_spacing_hz(layout.phy);
  frame.complete = assembled.complete;

  const Selection& selection = selection_for(layout);
  frame.tone_index = selection.tone_index;
  frame.csi = Csi(rows.rx_chains.size(), rows.streams, selection.tone_index.size());
  for (std::size_t i = 0; i < rows.slots.size(); ++i) {
    const auto from = assembled.row(rows.slots[i]);
    auto to = frame.csi.row(i / rows.streams, i % rows.streams).begin();
    for (const Run& run : selection.runs) {
      const auto wire = from.subspan(run.wire_begin, run.count);
      to = std::transform(wire.begin(), wire.end(), to, [&run](std::complex<float> h) {
        return derotated(h, run.quarter_turns);
      });
    }
  }
  set_flags(assembled, rows, frame);
  if (layout.stride > 1) {
    frame.flags.emplace_back("sparse_training");
  }
  if (header.common_power) {
    frame.flags.emplace_back("common_power");
  }
  frame.rx_chains = rows.rx_chains;
  for (const std::uint8_t rx_chain : frame.rx_chains) {
    frame.power_dbm.emplace_back(header.power_dbm[rx_chain]);
  }
  return frame;
}

}  // namespace rayloc
