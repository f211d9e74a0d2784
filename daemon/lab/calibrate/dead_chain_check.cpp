#include "daemon/lab/calibrate/dead_chain_check.h"

#include <algorithm>
#include <complex>
#include <cstddef>
#include <cstdint>

#include <spdlog/fmt/fmt.h>

#include "engine/channel/dead_row.h"

namespace rayloc {
namespace {

constexpr std::size_t kFewestSurveyFrames = 20;
constexpr std::size_t kFewestWeakPoints = 4;
// Share of the others' mean power that noise and coupling leave on a chain without an antenna
// (engine/room/preprocess_burst.cpp). The gains of working chains differ by less.
constexpr double kDeadShare = 0.01;

// Frames of the access point, and frames that contain the rx chain.
struct Presence {
  std::size_t frames = 0;
  std::size_t with_rx_chain = 0;
};

Presence presence_of(std::size_t access_point,
                     std::uint8_t rx_chain,
                     const CalibrationInputs& inputs) {
  Presence presence;
  for (const SurveyedFrames& surveyed : inputs.points) {
    for (const CsiFrame& frame : surveyed.frames) {
      if (frame.access_point == access_point) {
        ++presence.frames;
        presence.with_rx_chain += brings_rx_chain(frame, rx_chain) ? 1U : 0U;
      }
    }
  }
  return presence;
}

// True if the row is the weak one of that burst.
bool is_weak(const std::vector<std::complex<double>>& h, std::size_t rows, std::size_t row) {
  const std::size_t tones = h.size() / rows;
  double own = 0.0;
  double others = 0.0;
  for (std::size_t i = 0; i < h.size(); ++i) {
    (i / tones == row ? own : others) += std::norm(h[i]);
  }
  return own * static_cast<double>(rows - 1) < kDeadShare * others;
}

// Points with a burst of the access point, and points at which the row is weak.
struct WeakPoints {
  std::size_t received = 0;
  std::size_t weak = 0;
};

WeakPoints weak_points(const std::vector<CalibrationPoint>& points,
                       std::size_t access_point,
                       std::size_t rows,
                       std::size_t row) {
  WeakPoints result;
  for (const CalibrationPoint& point : points) {
    if (!point.h[access_point].empty() && rows > 1) {
      ++result.received;
      result.weak += is_weak(point.h[access_point], rows, row) ? 1U : 0U;
    }
  }
  return result;
}

}  // namespace

std::string dead_chains_of(const RoomModel& room,
                           const std::vector<CalibrationPoint>& points,
                           const CalibrationInputs& inputs) {
  std::string text;
  const auto add = [&](std::size_t access_point, std::uint8_t rx_chain, const std::string& what) {
    text += fmt::format(
        "{}access point {}: core {} {}: check its antenna and pigtail and survey again, or take "
        "the core out of site.toml",
        text.empty() ? "" : "\n",
        room.access_points[access_point].id,
        rx_chain,
        what);
  };
  for (std::size_t a = 0; a < room.access_points.size(); ++a) {
    const std::vector<std::uint8_t>& rx_chains = room.access_points[a].rx_chains;
    for (std::size_t row = 0; row < rx_chains.size(); ++row) {
      const Presence presence = presence_of(a, rx_chains[row], inputs);
      const WeakPoints weak = weak_points(points, a, rx_chains.size(), row);
      if (presence.frames >= kFewestSurveyFrames && 10 * presence.with_rx_chain < presence.frames) {
        add(a,
            rx_chains[row],
            fmt::format("has no CSI in {} of {} frames",
                        presence.frames - presence.with_rx_chain,
                        presence.frames));
      } else if (weak.received >= kFewestWeakPoints && 4 * weak.weak >= 3 * weak.received) {
        add(a,
            rx_chains[row],
            fmt::format(
                "is 20 dB weaker than the others at {} of {} points", weak.weak, weak.received));
      }
    }
  }
  return text;
}

}  // namespace rayloc
