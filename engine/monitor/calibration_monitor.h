// CalibrationMonitor: checks whether the calibration of a room still holds, from the bursts of
// transmitters at known positions. It reports warnings with numbers and changes nothing:
// recalibration is a manual step.
//
// Per access point, kBursts bursts make a window, in which the frames of each transmitter are
// averaged into one array. A warning is set and cleared after kSteady windows that agree: people
// who walk by spoil single windows.
//
// - kChainPhaseJump: the phase of a chain relative to the others changed by more than kJump and by
//   more than three sigmas of the effect of a centimetre of error in the positions (at most 75
//   degrees) and of the effect of the unexplained power. After a power cycle the chips start in one
//   of two or four states, at least a quarter turn apart; kJump is half of that. Where the room
//   explains so little (with one transmitter: less than about 0.91) that a quarter turn could not
//   be detected, chains are compared with the first windows that agreed: then only jumps after the
//   start are detected. A record from the calibration of the room removes this limit.
// - kAccessPointMoved: chain phases do not explain the observations, a shift or rotation within
//   kMaxShift and kMaxYaw does. The reported motion is the best fit to few transmitters.
// - kResidualDrift: the slow mean of the unexplained share is more than kDriftRatio times the usual
//   one and kMinDrift above it; it is cleared when half of that is left.
//
// Thread safety: none; call it from the owner's thread only.
#pragma once

#include <complex>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/channel/csi_frame.h"
#include "engine/likelihood/point_arrays.h"
#include "engine/monitor/debounce.h"
#include "engine/room/room_model.h"

namespace rayloc {

enum class CalibrationProblem {
  kChainPhaseJump,
  kAccessPointMoved,
  kResidualDrift,
  kDeadChain,  // from frames of any device (daemon/pipeline/watch/dead_chains.h)
};

struct CalibrationWarning {
  CalibrationProblem problem = CalibrationProblem::kResidualDrift;
  std::size_t access_point = 0;  // of the room
  int rx_chain = -1;             // the chain that jumped or is dead
  double phase = 0.0;            // [rad], size of the jump
  ArrayMotion motion;            // of a moved access point
  double fit = 0.0;              // share of the measured power that the room explains now
  double usual_fit = 0.0;
  std::string text;  // "chain_phase_jump: access point ap1, core 3: by 92 degrees ..."

  // True for a warning of the same fault, independent of its numbers.
  bool same_as(const CalibrationWarning& other) const {
    return problem == other.problem && access_point == other.access_point &&
           rx_chain == other.rx_chain;
  }
};

class CalibrationMonitor {
 public:
  // A count, chosen: several, since people who walk by spoil single ones.
  static constexpr std::size_t kBursts = 5;
  static constexpr int kSteady = 2;  // a count of windows, chosen: a single window may be spoilt
  // Windows from one scan to the next: a scan costs as much as ten fixes.
  static constexpr int kRescan = 10;
  static constexpr double kJump = 0.785;       // [rad]
  static constexpr double kMaxShift = 0.05;    // [m], along x and y of the room
  static constexpr double kMaxYaw = 0.105;     // [rad], 6 degrees
  static constexpr double kDriftRatio = 3.0;   // people and doors change the share by less
  static constexpr double kMinDrift = 0.05;    // noise changes the unexplained share by less
  static constexpr double kPlaceSigma = 0.01;  // [m], of stated positions

  // `usual_fit`: median squared normalised correlation of each access point at calibration;
  // nothing: that of its first kSteady windows.
  explicit CalibrationMonitor(std::shared_ptr<const RoomModel> room,
                              std::vector<std::optional<double>> usual_fit = {});
  ~CalibrationMonitor();

  struct Transmitter {
    Vec3d position;  // [m]
    DeviceModel device;
  };
  // Sets the array [rx_chain][tone] that an access point received from a transmitter when the room
  // was calibrated, with chains removed (PersonLink::empty). It replaces the prediction of the
  // room. Call it before the first burst. REQUIRES: an access point with gains, an array of its
  // size.
  void set_reference(const Transmitter& transmitter,
                     std::size_t access_point,
                     std::vector<std::complex<double>> array);

  // State of an access point after its windows. Later windows do not reproduce it: a monitor that
  // replaces another one has to be given this state.
  struct MonitorState {
    // State before the first window.
    MonitorState(std::size_t ap, std::size_t chains, std::optional<double> usual_fit)
        : access_point(ap), usual(usual_fit), jump(chains, Debounce(kSteady)), jump_phase(chains) {}
    std::size_t access_point;
    std::size_t bursts = 0;  // in the current window
    std::optional<double> usual;
    std::vector<double> first;                  // fits of the first windows, until `usual` is set
    double fit = 0.0;                           // of the last window
    std::optional<double> slow = std::nullopt;  // mean of the unexplained share
    Debounce moved{kSteady};
    std::vector<Debounce> jump;      // of each chain
    std::vector<double> jump_phase;  // [rad]
    ArrayMotion motion;
    double moved_fit = 0.0;
    int since_scan = kRescan;  // windows
    bool drifted = false;
  };
  std::vector<MonitorState> monitor_state() const;  // by access point
  // Call before the first burst and after set_reference(). Access points of this room only.
  void go_on(const std::vector<MonitorState>& monitor_state);

  // Adds the frames of one burst of a transmitter from all access points. Access points without
  // gains and those that no ray reaches are skipped.
  void observe(const Transmitter& transmitter, std::span<const CsiFrame> frames);

  // Resets to the state before the first burst, for a new time span; stated arrays stay.
  void restart();

  // Current warnings, by access point.
  std::vector<CalibrationWarning> warnings() const;

 private:
  class AccessPoint;
  std::shared_ptr<const RoomModel> room_;
  std::vector<std::unique_ptr<AccessPoint>> aps_;  // nullptr without gains
};

}  // namespace rayloc
