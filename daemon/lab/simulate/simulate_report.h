// The truth of simulated recordings, as values, as JSON and as csv.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "daemon/lab/simulate/capture_simulator.h"
#include "daemon/lab/simulate/handling.h"
#include "daemon/lab/simulate/second_day.h"
#include "engine/channel/radio_channel.h"
#include "engine/observe/chain_gains.h"

namespace rayloc {

struct CaptureReport {
  std::string access_point;
  std::string file;
  std::size_t datagrams = 0;
  std::size_t lost = 0;
  std::vector<int> lines_without_path;  // lines of the points file without a path
  ChainGains chains;
};

// The complete truth of the simulation.
struct SimulatedTruth {
  CaptureOptions options;
  std::vector<SimulatedPoint> test_points;
  bool is_walk = false;
  std::vector<CaptureReport> captures;  // in the order of the recordings
  Handling handling = {};
  std::optional<SecondDay> day = {};        // empty: the first day
  LivedInRoom lived = {};                   // the room on `day`
  std::vector<RadioChannel> channels = {};  // hop channels of the device; empty: the site's
};

// One object on a line: `seed, transmitter, depth, transmission, frames, impairments{key: value},
// access_points[{id, file, datagrams, lost, unheard_lines[], chains[{core, gain_db,
// phase_deg}]}], points[{line, x, y, z}]`, with the true points of the device. Gain and phase of a
// chain are means over the tones relative to the access point's first chain, as in `rayloc
// calibrate`.
//
// For a device that hops, `channels[{centre_hz, bandwidth_mhz}]`; the chains are then those on the
// first of them. For hand-held devices, `handling{height_sigma_m, tilt_deg, power_sigma_db}` and,
// for each point, `tilt_deg, tilt_towards_deg, power_db`. For a second day, `second_day{key: value,
// things[{objects[], by[3]}], access_points[{id, moved_m[3], yaw_deg, pitch_deg, roll_deg}]}`; the
// angles are changes of the pose.
std::string simulation_json(const SimulatedTruth& truth);

// The points as a file for `rayloc evaluate --truth`: `t_start,t_end,x,y,z`, for a walk `t,x,y,z`,
// and for hand-held devices further columns as above.
std::string truth_csv(const SimulatedTruth& truth);

}  // namespace rayloc
