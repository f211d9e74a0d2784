#include "engine/observe/burst.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "engine/base/median.h"
#include "engine/channel/dead_row.h"
#include "engine/observe/alignment.h"
#include "engine/observe/unit_power.h"

namespace rayloc {
namespace {

using Value = std::complex<double>;

struct Reading {
  Timestamp time;
  std::vector<Value> values;  // [rx_chain][tone] in the order of the request
  std::optional<double> power_dbm;
};

// Position in `frame.tone_index` of every tone of the grid; nothing when one is missing.
std::optional<std::vector<std::size_t>> tone_positions(const CsiFrame& frame,
                                                       const OfdmGrid& grid) {
  std::vector<std::size_t> positions;
  positions.reserve(grid.size());
  for (const std::int16_t tone : grid.tone_index) {
    const auto found = std::lower_bound(frame.tone_index.begin(), frame.tone_index.end(), tone);
    if (found == frame.tone_index.end() || *found != tone) {
      return std::nullopt;
    }
    positions.push_back(static_cast<std::size_t>(found - frame.tone_index.begin()));
  }
  return positions;
}

// Mean power of the cores; nothing where it is not stated for all of them.
std::optional<double> power_dbm_of(const CsiFrame& frame, std::span<const std::uint8_t> rx_chains) {
  double power = 0.0;  // [mW]
  for (const std::uint8_t rx_chain : rx_chains) {
    const auto at = static_cast<std::size_t>(
        std::find(frame.rx_chains.begin(), frame.rx_chains.end(), rx_chain) -
        frame.rx_chains.begin());
    if (at >= frame.power_dbm.size() || !frame.power_dbm[at]) {
      return std::nullopt;
    }
    power += std::pow(10.0, 0.1 * static_cast<double>(*frame.power_dbm[at]));
  }
  return 10.0 * std::log10(power / static_cast<double>(rx_chains.size()));
}

std::optional<double> power_dbm_of(const std::vector<Reading>& readings) {
  std::vector<double> powers;
  for (const Reading& reading : readings) {
    if (reading.power_dbm) {
      powers.push_back(*reading.power_dbm);
    }
  }
  return powers.empty() ? std::nullopt : std::optional(median(std::move(powers)));
}

// The values of a frame, or the name of the reason for refusing it.
Expected<Reading> read_frame(const CsiFrame& frame, const BurstRequest& request) {
  if (frame.csi.streams() != 1) {
    return bad_input("several_streams");
  }
  if (std::abs(frame.tone_spacing_hz - request.grid.spacing_hz) > 1.0) {
    return bad_input("wrong_grid");
  }
  const auto tones = tone_positions(frame, request.grid);
  if (!tones) {
    return bad_input("wrong_grid");
  }
  Reading reading{frame.time, {}, power_dbm_of(frame, request.rx_chains)};
  reading.values.reserve(request.rx_chains.size() * tones->size());
  for (const std::uint8_t rx_chain : request.rx_chains) {
    const auto found = std::find(frame.rx_chains.begin(), frame.rx_chains.end(), rx_chain);
    if (found == frame.rx_chains.end()) {
      return bad_input("missing_core");
    }
    const auto row = frame.csi.row(static_cast<std::size_t>(found - frame.rx_chains.begin()), 0);
    if (is_dead(row)) {
      return bad_input("dead_core");
    }
    double power = 0.0;
    for (const std::size_t tone : *tones) {
      const Value value(static_cast<double>(row[tone].real()),
                        static_cast<double>(row[tone].imag()));
      power += std::norm(value);
      reading.values.push_back(value);
    }
    if (!std::isfinite(power) || power <= 0.0) {
      return bad_input("dead_core");
    }
  }
  return reading;
}

std::vector<Value> mean_of(const std::vector<Reading>& readings,
                           std::size_t begin,
                           std::size_t end) {
  std::vector<Value> mean(readings.front().values.size());
  for (std::size_t i = begin; i < end; ++i) {
    for (std::size_t j = 0; j < mean.size(); ++j) {
      mean[j] += readings[i].values[j];
    }
  }
  const double scale = 1.0 / static_cast<double>(end - begin);
  for (Value& v : mean) {
    v *= scale;
  }
  return mean;
}

// Aligns every reading to the running average, twice, the second time without outliers. The
// readings kept are aligned and on the scale of the result.
std::vector<Value> average(std::vector<Reading>& readings,
                           const Aligner& aligner,
                           const BurstOptions& options,
                           BurstObservation& result) {
  std::vector<Value> reference = readings.front().values;
  if (readings.size() == 1 && !options.aligns_single_frame) {
    return reference;
  }
  for (int pass = 0; pass < 2; ++pass) {
    scale_to_unit(reference);
    for (Reading& reading : readings) {
      aligner.apply(aligner.align(reference, reading.values), reading.values);
    }
    reference = mean_of(readings, 0, readings.size());
    if (pass == 0) {
      const std::size_t before = readings.size();
      std::erase_if(readings, [&](const Reading& reading) {
        return aligner.align(reference, reading.values).correlation < options.min_correlation;
      });
      if (readings.size() < before) {
        result.refused["different"] += before - readings.size();
      }
      if (readings.empty()) {
        return {};
      }
      reference = mean_of(readings, 0, readings.size());
    }
  }
  return reference;
}

double noise_of_frames(const std::vector<Reading>& readings, const std::vector<Value>& mean) {
  double sum = 0.0;
  for (const Reading& reading : readings) {
    for (std::size_t j = 0; j < mean.size(); ++j) {
      sum += std::norm(reading.values[j] - mean[j]);
    }
  }
  return sum / (static_cast<double>(readings.size() - 1) * static_cast<double>(mean.size()));
}

// Second differences along the tones: noise has six times its variance in them, the channel of a
// room contributes far less.
double noise_of_tones(const std::vector<Value>& values, std::size_t tones) {
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t row = 0; row < values.size(); row += tones) {
    for (std::size_t k = 1; k + 1 < tones; ++k) {
      sum += std::norm(values[row + k - 1] - 2.0 * values[row + k] + values[row + k + 1]);
      ++count;
    }
  }
  return count == 0 ? 1.0 : sum / (6.0 * static_cast<double>(count));
}

// 1 - |correlation|^2 of the averages of the first and of the second half, minus the noise part.
double motion_between_halves(const std::vector<Reading>& readings,
                             const Aligner& aligner,
                             double frame_noise) {
  const std::size_t half = readings.size() / 2;
  if (half == 0) {
    return 0.0;
  }
  const auto early = mean_of(readings, 0, half);
  const auto late = mean_of(readings, half, readings.size());
  const double expected = frame_noise * (1.0 / static_cast<double>(half) +
                                         1.0 / static_cast<double>(readings.size() - half));
  return std::max(0.0, 1.0 - aligner.align(early, late).correlation - expected);
}

std::string describe(const std::map<std::string, std::size_t>& refused) {
  std::string text;
  for (const auto& [reason, count] : refused) {
    text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + reason;
  }
  return text;
}

// The frames of the access point, at most `most` of them, evenly spread.
std::vector<const CsiFrame*> choose(std::span<const CsiFrame> frames,
                                    std::size_t access_point,
                                    std::size_t most,
                                    std::size_t& unread) {
  std::vector<const CsiFrame*> own;
  for (const CsiFrame& frame : frames) {
    if (frame.access_point == access_point) {
      own.push_back(&frame);
    }
  }
  if (own.size() <= most) {
    return own;
  }
  std::vector<const CsiFrame*> chosen;
  for (std::size_t i = 0; i < most; ++i) {
    chosen.push_back(own[i * (own.size() - 1) / (most > 1 ? most - 1 : 1)]);
  }
  unread = own.size() - chosen.size();
  return chosen;
}

bool has_rx_chain(const CsiFrame& frame, std::uint8_t rx_chain) {
  return std::find(frame.rx_chains.begin(), frame.rx_chains.end(), rx_chain) !=
         frame.rx_chains.end();
}

// Rows of the request that have no measurement in the frame.
std::vector<std::size_t> lacking(const CsiFrame& frame, const BurstRequest& request) {
  std::vector<std::size_t> rows;
  for (std::size_t row = 0; row < request.rx_chains.size(); ++row) {
    if (!brings_rx_chain(frame, request.rx_chains[row])) {
      rows.push_back(row);
    }
  }
  return rows;
}

// True if a missing core is no packet loss: its datagram came, or the core is long absent.
bool is_no_loss(const CsiFrame& frame, std::uint8_t rx_chain) {
  return has_rx_chain(frame, rx_chain) ||
         std::find(frame.flags.begin(), frame.flags.end(), "absent_core") != frame.flags.end();
}

// The absent core; nothing where a frame has all cores, or none lacks only one.
std::optional<AbsentRxChain> absent_rx_chain(const std::vector<const CsiFrame*>& frames,
                                             const BurstRequest& request) {
  std::vector<std::size_t> alone(request.rx_chains.size());  // frames that lack this row only
  std::vector<std::size_t> lasting(request.rx_chains.size());
  for (const CsiFrame* frame : frames) {
    if (frame->csi.streams() != 1) {
      continue;
    }
    const std::vector<std::size_t> rows = lacking(*frame, request);
    if (rows.empty()) {
      return std::nullopt;
    }
    // A frame with the requested number of cores has other cores than stated, and none is dead.
    const bool is_absent =
        rows.size() == 1 && (has_rx_chain(*frame, request.rx_chains[rows.front()]) ||
                             frame->rx_chains.size() < request.rx_chains.size());
    if (is_absent) {
      ++alone[rows.front()];
      lasting[rows.front()] += is_no_loss(*frame, request.rx_chains[rows.front()]) ? 1U : 0U;
    }
  }
  const auto most = std::max_element(alone.begin(), alone.end());
  if (request.rx_chains.size() < 2 || *most == 0) {
    return std::nullopt;
  }
  const auto row = static_cast<std::size_t>(most - alone.begin());
  return AbsentRxChain{row, lasting[row] == *most};
}

Expected<BurstObservation> without_absent(std::span<const CsiFrame> frames,
                                          BurstRequest request,
                                          AbsentRxChain absent) {
  const auto at = static_cast<std::ptrdiff_t>(absent.row);
  const std::uint8_t rx_chain = request.rx_chains[absent.row];
  request.options.leaves_out_absent = false;
  request.rx_chains.erase(request.rx_chains.begin() + at);
  auto burst = combine_burst(frames, request);
  if (burst) {
    const auto tones = request.grid.size();
    burst->h.insert(burst->h.begin() + at * static_cast<std::ptrdiff_t>(tones), tones, Value());
    burst->rx_chains.insert(burst->rx_chains.begin() + at, rx_chain);
    burst->power_dbm.reset();
    burst->absent = absent;
  }
  return burst;
}

}  // namespace

Expected<BurstObservation> combine_burst(std::span<const CsiFrame> frames,
                                         const BurstRequest& request) {
  BurstObservation result;
  result.access_point = request.access_point;
  const auto chosen = choose(frames,
                             request.access_point,
                             std::max<std::size_t>(request.options.max_frames, 1),
                             result.frames_unread);
  if (chosen.empty()) {
    return bad_input("no frames");
  }
  if (request.grid.size() < 2 || request.rx_chains.empty()) {
    return bad_input("nothing is asked for: the grid or the list of cores is empty");
  }
  if (request.options.leaves_out_absent) {
    if (const auto absent = absent_rx_chain(chosen, request)) {
      return without_absent(frames, request, *absent);
    }
  }
  std::vector<Reading> readings;
  for (const CsiFrame* frame : chosen) {
    auto reading = read_frame(*frame, request);
    if (reading) {
      scale_to_unit(reading->values);
      readings.push_back(*std::move(reading));
    } else {
      ++result.refused[reading.error().message];
    }
  }
  if (readings.empty()) {
    return bad_input("no usable frame among " + std::to_string(chosen.size()) + " (" +
                     describe(result.refused) + ")");
  }
  const Aligner aligner(request.grid);
  result.h = average(readings, aligner, request.options, result);
  if (readings.empty()) {
    return bad_input("the frames of the burst have nothing in common (" + describe(result.refused) +
                     ")");
  }
  const double frame_noise = readings.size() > 1 ? noise_of_frames(readings, result.h)
                                                 : noise_of_tones(result.h, request.grid.size());
  result.motion_residual = motion_between_halves(readings, aligner, frame_noise);
  double power = 0.0;
  for (const Value& v : result.h) {
    power += std::norm(v);
  }
  power /= static_cast<double>(result.h.size());
  scale_to_unit(result.h);
  const auto count = static_cast<double>(readings.size());
  result.noise_variance = frame_noise / (count * power);
  constexpr double kMinNoise = 1e-12;  // a noiseless simulation has a finite SNR as well
  result.snr_db = 10.0 * std::log10(power / std::max(frame_noise, kMinNoise));
  result.transmitter = chosen.front()->transmitter;
  result.power_dbm = power_dbm_of(readings);
  result.first = readings.front().time;
  result.last = readings.back().time;
  result.frames_used = readings.size();
  result.grid = request.grid;
  result.rx_chains = request.rx_chains;
  return result;
}

}  // namespace rayloc
