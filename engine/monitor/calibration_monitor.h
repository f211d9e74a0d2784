// CalibrationMonitor: whether a calibrated room still holds, from the bursts of transmitters that
// stand at known places. It warns with numbers and changes nothing: calibrating again is for
// people.
//
// Per access point, kBursts bursts make a window, in which the frames of each transmitter are
// averaged into one array. A warning appears and goes after kSteady windows that agree: people who
// walk by spoil single windows.
//
// - kChainPhaseJump: a chain is turned against the others by more than kJump and more than three
//   sigmas of what a centimetre of error in the places does (at most 75 degrees) and of what the
//   power that the room does not explain may do. After a power cycle the chips start in one of two
//   or four states, at least a quarter turn apart; kJump is half of that. Where the room explains
//   so little of them (with one: less than about 0.91) that a quarter turn could not be told,
//   chains are compared with the first windows that agreed: a jump is then seen when it happens,
//   not one from before the start. What was heard when the room was calibrated tells both.
// - kAccessPointMoved: the chains do not explain what is heard, and the array shifted or turned
//   within kMostShift and kMostYaw does. Stated is what explains most of what few transmitters see.
// - kResidualDrift: the slow mean of the share that the room leaves unexplained is more than
//   kDriftRatio times the usual one and kLeastDrift above; it goes when half of that is left.
//
// Thread safety: none; the owner's thread alone.
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
#include "engine/likelihood/spot_arrays.h"
#include "engine/monitor/debounce.h"
#include "engine/room/room_model.h"

namespace rayloc {

enum class CalibrationProblem {
  kChainPhaseJump,
  kAccessPointMoved,
  kResidualDrift,
  kDeadChain,  // by frames of anyone (daemon/pipeline/watch/dead_chains.h)
};

struct CalibrationWarning {
  CalibrationProblem problem = CalibrationProblem::kResidualDrift;
  std::size_t access_point = 0;  // of the room
  int core = -1;                 // whose chain has jumped, or is dead
  double phase = 0.0;            // [rad], by how much
  ArrayMotion motion;            // of a moved access point
  double fit = 0.0;              // share of the measured power that the room explains now
  double usual_fit = 0.0;
  std::string text;  // "chain_phase_jump: access point ap1, core 3: by 92 degrees ..."

  // The same trouble, whatever its numbers.
  bool same_as(const CalibrationWarning& other) const {
    return problem == other.problem && access_point == other.access_point && core == other.core;
  }
};

class CalibrationMonitor {
 public:
  // A count, chosen: several, as people who walk by spoil one.
  static constexpr std::size_t kBursts = 5;
  static constexpr int kSteady = 2;  // a count of windows, chosen: one alone may be spoilt
  // Windows from one scan to the next: it takes as long as ten fixes.
  static constexpr int kRescan = 10;
  static constexpr double kJump = 0.785;       // [rad]
  static constexpr double kMostShift = 0.05;   // [m], along x and y of the room
  static constexpr double kMostYaw = 0.105;    // [rad], 6 degrees
  static constexpr double kDriftRatio = 3.0;   // people and doors move the share by less
  static constexpr double kLeastDrift = 0.05;  // what noise leaves unexplained moves by less
  static constexpr double kPlaceSigma = 0.01;  // [m], of stated places

  // `usual_fit`: median squared normalised correlation of each access point when it was calibrated;
  // nothing: that of its first kSteady windows.
  explicit CalibrationMonitor(std::shared_ptr<const RoomModel> room,
                              std::vector<std::optional<double>> usual_fit = {});
  ~CalibrationMonitor();

  struct Transmitter {
    Vec3d position;  // [m]
    DeviceModel device;
  };
  // States what an access point heard of a transmitter when the room was calibrated, [core][tone]
  // with chains removed (PersonLink::empty): instead of what the room expects of it. Before the
  // first burst. REQUIRES: an access point with gains, an array of its size.
  void know(const Transmitter& transmitter,
            std::size_t access_point,
            std::vector<std::complex<double>> array);

  // What the windows of an access point have told. Later windows do not tell it again: who goes on
  // in place of another monitor has to be told.
  struct Told {
    // Before the first window.
    Told(std::size_t ap, std::size_t chains, std::optional<double> usual_fit)
        : access_point(ap), usual(usual_fit), jump(chains, Debounce(kSteady)), jump_phase(chains) {}
    std::size_t access_point;
    std::size_t bursts = 0;  // of the window that is not over
    std::optional<double> usual;
    std::vector<double> first;                  // fits of the first windows, until `usual` is known
    double fit = 0.0;                           // of the last window
    std::optional<double> slow = std::nullopt;  // mean of what is unexplained
    Debounce moved{kSteady};
    std::vector<Debounce> jump;      // of each chain
    std::vector<double> jump_phase;  // [rad]
    ArrayMotion motion;
    double moved_fit = 0.0;
    int since_scan = kRescan;  // windows
    bool drifted = false;
  };
  std::vector<Told> told() const;  // by access point
  // Before the first burst, and after know(). Of the room's access points only.
  void go_on(const std::vector<Told>& told);

  // The frames of a burst of a transmitter, of all access points. Access points without gains and
  // those that no ray reaches are left alone.
  void observe(const Transmitter& transmitter, std::span<const CsiFrame> frames);

  // As before the first burst, for what comes next is of another time; what was stated still holds.
  void restart();

  // What holds now, by access point.
  std::vector<CalibrationWarning> warnings() const;

 private:
  class AccessPoint;
  std::shared_ptr<const RoomModel> room_;
  std::vector<std::unique_ptr<AccessPoint>> aps_;  // nullptr without gains
};

}  // namespace rayloc
