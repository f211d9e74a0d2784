// RoomUnknowns: the parameters of a room that the joint calibration may change, as one list of
// numbers, each with a Gaussian prior of mean 0 and deviation sigma.
//
// All are changes relative to the input model (floor plan, survey, table of materials), so that
// values, scans and posteriors of all kinds are handled alike.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/base/expected.h"
#include "engine/room/parameter_id.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct CalibrationPriors {
  double room_surface = 0.015;      // [m], walls, floor, ceiling: the surfaces that bound the room
  double furniture_surface = 0.03;  // [m], surfaces inside the room
  double position = 0.005;          // [m], of the access point, each axis
  double angle = 0.02;              // [rad], each of three angles
  double element = 0.001;           // [m], of an antenna along the array's y
  double chain = 0.3;               // natural logarithm of gain, and phase [rad]: error that the
                                    // initial chain gains leave
  double coupling = 0.03;           // of two antennas, real and imaginary part: about -28 dB
  double permittivity = 0.2;        // natural logarithm
  double conductivity = 0.5;
  double thickness = 0.2;
  double surface_gain = 0.15;   // natural logarithm of a factor on all that a surface reflects
  double surface_phase = 0.25;  // [rad]
  double survey = 0.005;        // [m], of a surveyed point, each axis
};

// Kind and index of an unknown.
struct Unknown {
  enum class Kind : std::uint8_t {
    kSurfaceOffset,    // [m] along the normal of surface `index`
    kSurfaceGain,      // of surface `index`; natural logarithm
    kSurfacePhase,     // [rad]
    kPermittivity,     // of material `index`; natural logarithm of the factor
    kConductivity,     // "
    kThickness,        // "
    kArrayPosition,    // [m], world axis `part` of access point `index`
    kArrayAngle,       // [rad], yaw, pitch, roll
    kElementPosition,  // [m], along the array's y, of element `part`
    kChainGain,        // natural logarithm, of element `part` > 0
    kChainPhase,       // [rad]
    kCoupling,         // of two antennas; `part` in the order of RoomUnknowns::coupling()
  };
  Kind kind = Kind::kSurfaceOffset;
  std::uint32_t index = 0;
  std::uint32_t part = 0;
  double sigma = 1.0;  // of the prior
};

class RoomUnknowns {
 public:
  RoomUnknowns(const RoomModel& room, const CalibrationPriors& priors);

  std::size_t size() const { return unknowns_.size(); }
  const Unknown& operator[](std::size_t i) const { return unknowns_[i]; }
  const std::vector<Unknown>& all() const { return unknowns_; }

  std::uint32_t surface_offset(std::uint32_t surface) const { return surface; }
  std::uint32_t surface_gain(std::uint32_t surface) const { return surfaces_ + 2 * surface; }
  std::uint32_t surface_phase(std::uint32_t surface) const { return surface_gain(surface) + 1; }
  std::uint32_t permittivity(std::uint32_t material) const { return materials_at_ + 3 * material; }
  std::uint32_t array_position(std::size_t access_point) const { return arrays_at_[access_point]; }
  std::uint32_t array_angle(std::size_t access_point) const { return arrays_at_[access_point] + 3; }
  std::uint32_t element_position(std::size_t access_point, std::size_t element) const {
    return arrays_at_[access_point] + 6 + static_cast<std::uint32_t>(element);
  }
  // REQUIRES: element > 0; the phase follows the gain.
  std::uint32_t chain_gain(std::size_t access_point, std::size_t element) const;
  // Real and imaginary part of the coupling into element 0 from 1, from 2 ..., into 1 from 0 ...
  std::uint32_t coupling(std::size_t access_point) const;

 private:
  void add_surfaces(const RoomModel& room, const CalibrationPriors& priors);
  void add_arrays(const RoomModel& room, const CalibrationPriors& priors);

  std::vector<Unknown> unknowns_;
  std::uint32_t surfaces_ = 0;
  std::uint32_t materials_at_ = 0;
  std::vector<std::uint32_t> arrays_at_;
  std::vector<std::size_t> elements_;
};

// The room with all changes except the gains and phases of surfaces, which a scene cannot contain:
// they are in RoomModel::surface_correction. Chain gains are multiplied.
Expected<RoomModel> changed_room(const RoomModel& original,
                                 const RoomUnknowns& unknowns,
                                 const std::vector<double>& values);

ParameterId parameter_id(const Unknown& unknown, const RoomModel& room);

}  // namespace rayloc
