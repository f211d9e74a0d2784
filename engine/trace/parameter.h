// Parameter: a number that the paths of a link depend on and can be differentiated by.
//
// The following have no derivative in this code and are no Parameters, so code that requests them
// does not compile: the carrier, the depth, the softness, a rotation of an object, the shape of a
// sampled antenna pattern.
#pragma once

#include <cstdint>
#include <string>

namespace rayloc {

struct Parameter {
  enum class Kind : std::uint8_t {
    kTransmitterPosition,     // [m], world axis
    kReceiverPosition,        // [m], world axis
    kTransmitterOrientation,  // [rad], yaw, pitch or roll about the antenna
    kReceiverOrientation,     // [rad]
    kTransmitterArrayTurn,  // [rad], yaw, pitch or roll of the array about its origin: the antenna
    kReceiverArrayTurn,     //        moves and turns (RadioDevice::lever)
    kTransmitterGain,       // amplitude factor of the antenna, at 1
    kReceiverGain,
    kObjectTranslation,     // [m], world axis; faces and their edges move
    kSurfaceOffset,         // [m], along the plane's normal
    kRelativePermittivity,  // of a material, real part
    kConductivity,          // [S/m]
    kThickness,             // [m]
    // For a material that scatters (em/surface_scattering.h), with TraceOptions::diffuse.
    kScatteringCoefficient,
    kXpdCoefficient,
    kAlphaReflected,  // alpha_r
    kAlphaBack,       // alpha_i
    kLobeShare,       // lambda_
  };

  Kind kind = Kind::kTransmitterPosition;
  std::uint32_t index = 0;  // of the object, the surface or the material
  int axis = 0;             // 0..2: x, y, z; yaw, pitch, roll

  static Parameter transmitter_position(int axis) { return {Kind::kTransmitterPosition, 0, axis}; }
  static Parameter receiver_position(int axis) { return {Kind::kReceiverPosition, 0, axis}; }
  static Parameter transmitter_orientation(int axis) {
    return {Kind::kTransmitterOrientation, 0, axis};
  }
  static Parameter receiver_orientation(int axis) { return {Kind::kReceiverOrientation, 0, axis}; }
  static Parameter transmitter_array_turn(int axis) {
    return {Kind::kTransmitterArrayTurn, 0, axis};
  }
  static Parameter receiver_array_turn(int axis) { return {Kind::kReceiverArrayTurn, 0, axis}; }
  static Parameter transmitter_gain() { return {Kind::kTransmitterGain, 0, 0}; }
  static Parameter receiver_gain() { return {Kind::kReceiverGain, 0, 0}; }
  static Parameter object_translation(std::uint32_t object, int axis) {
    return {Kind::kObjectTranslation, object, axis};
  }
  static Parameter surface_offset(std::uint32_t surface) {
    return {Kind::kSurfaceOffset, surface, 0};
  }
  static Parameter relative_permittivity(std::uint32_t material) {
    return {Kind::kRelativePermittivity, material, 0};
  }
  static Parameter conductivity(std::uint32_t material) {
    return {Kind::kConductivity, material, 0};
  }
  static Parameter thickness(std::uint32_t material) { return {Kind::kThickness, material, 0}; }
  static Parameter scattering(Kind kind, std::uint32_t material) { return {kind, material, 0}; }

  friend bool operator==(const Parameter&, const Parameter&) = default;
};

}  // namespace rayloc
