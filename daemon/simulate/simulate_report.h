// What `rayloc simulate` prints: the truth behind its recordings, as JSON.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "daemon/simulate/capture_simulator.h"
#include "engine/observe/chain_gains.h"

namespace rayloc::cli {

struct CaptureReport {
  std::string access_point;
  std::string file;
  std::size_t datagrams = 0;
  std::size_t lost = 0;
  std::vector<int> unheard_lines;  // of the points file: no path from there
  ChainGains chains;
};

// One object on a line: `seed, transmitter, depth, transmission, frames, impairments{key: value},
// access_points[{id, file, datagrams, lost, unheard_lines[], chains[{core, gain_db, phase_deg}]}],
// points[{line, x, y, z}]`, the points as the device really stood. Gain and phase of a chain are
// means over the tones against the access point's first chain, as `rayloc calibrate` reports them.
std::string simulation_json(const CaptureOptions& options,
                            std::span<const SimulatedSpot> spots,
                            std::span<const CaptureReport> captures);

}  // namespace rayloc::cli
