#include "daemon/lab/recordings/frame_arrays.h"

#include <algorithm>
#include <limits>
#include <set>
#include <string_view>

#include "daemon/base/arrays/npz_file.h"

namespace rayloc {
namespace {

template <std::size_t N>
void put(std::string_view text, std::array<char, N>& into) {
  std::copy_n(text.begin(), std::min(text.size(), N), into.begin());
}

FrameHeader header_of(const CsiFrame& frame) {
  FrameHeader header;
  header.time = frame.time.time_since_epoch().count();
  header.time_last = frame.time_last.time_since_epoch().count();
  header.tone_spacing = frame.tone_spacing_hz;
  header.channel_centre = frame.channel ? frame.channel->centre_hz : 0.0;
  header.access_point = static_cast<std::int32_t>(frame.access_point);
  header.bandwidth_mhz = frame.bandwidth_mhz;
  header.channel_bandwidth_mhz = frame.channel_bandwidth_mhz;
  header.streams = static_cast<std::int32_t>(frame.csi.streams());
  header.sequence = frame.sequence;
  header.sequence_control = frame.sequence_control;
  header.complete = frame.complete;
  put(to_string(frame.transmitter), header.transmitter);
  put(frame.format, header.format);
  put(to_string(frame.phy), header.phy);
  std::string flags;
  for (const std::string_view flag : frame.flags) {
    flags += (flags.empty() ? "" : ",") + std::string(flag);
  }
  put(flags, header.flags);
  return header;
}

template <typename T>
std::size_t place_of(const std::vector<T>& all, T one) {
  return static_cast<std::size_t>(std::lower_bound(all.begin(), all.end(), one) - all.begin());
}

void add_frame(const CsiFrame& frame, std::size_t number, std::size_t stream, FrameArrays& arrays) {
  const std::size_t rx_chains = arrays.rx_chains.size();
  const std::size_t tones = arrays.tone_index.size();
  std::vector<std::size_t> columns;
  columns.reserve(frame.tone_index.size());
  for (const std::int16_t tone : frame.tone_index) {
    columns.push_back(place_of(arrays.tone_index, tone));
  }
  for (std::size_t i = 0; i < frame.rx_chains.size(); ++i) {
    const std::size_t rx_chain = place_of(arrays.rx_chains, frame.rx_chains[i]);
    if (i < frame.power_dbm.size() && frame.power_dbm[i]) {
      arrays.power_dbm[number * rx_chains + rx_chain] = *frame.power_dbm[i];
    }
    if (stream >= frame.csi.streams()) {
      continue;
    }
    const auto row = frame.csi.row(i, stream);
    const std::size_t first = (number * rx_chains + rx_chain) * tones;
    for (std::size_t j = 0; j < columns.size(); ++j) {
      arrays.csi[first + columns[j]] = row[j];
      arrays.mask[first + columns[j]] = 1;
    }
  }
}

}  // namespace

FrameArrays frame_arrays(std::span<const CsiFrame> frames, std::size_t stream) {
  std::set<std::uint8_t> rx_chains;
  std::set<std::int16_t> tones;
  for (const CsiFrame& frame : frames) {
    rx_chains.insert(frame.rx_chains.begin(), frame.rx_chains.end());
    tones.insert(frame.tone_index.begin(), frame.tone_index.end());
  }
  FrameArrays arrays;
  arrays.rx_chains.assign(rx_chains.begin(), rx_chains.end());
  arrays.tone_index.assign(tones.begin(), tones.end());
  const std::size_t rows = frames.size() * rx_chains.size();
  arrays.csi.resize(rows * tones.size());
  arrays.mask.resize(rows * tones.size());
  arrays.power_dbm.assign(rows, std::numeric_limits<float>::quiet_NaN());
  arrays.headers.reserve(frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    arrays.headers.push_back(header_of(frames[i]));
    add_frame(frames[i], i, stream, arrays);
  }
  return arrays;
}

Expected<void> write_npz(const FrameArrays& arrays,
                         const std::vector<std::string>& access_points,
                         const std::string& path) {
  auto file = NpzFile::create(path);
  RAYLOC_TRY(file);
  const auto shape = arrays.shape();
  const auto bytes = [](const auto& values) { return std::as_bytes(std::span(values)); };
  file->add("csi", arrays.csi, shape);
  file->add("mask", "'|b1'", bytes(arrays.mask), shape);
  file->add("headers", kFrameHeaderDescr, bytes(arrays.headers), {shape[0]});
  file->add("power_dbm", arrays.power_dbm, {shape[0], shape[1]});
  file->add("cores", arrays.rx_chains, {shape[1]});
  file->add("tone_index", arrays.tone_index, {shape[2]});
  file->add_texts("access_points", access_points);
  return file->close();
}

}  // namespace rayloc
