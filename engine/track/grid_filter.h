// GridFilter: a Bayes filter over the cells of a room for one standing or walking target.
//
// METHODS B6. Each cell has a mass per mode of motion: one mode is standing, the others are walks
// in eight directions at two speeds. Walking mass moves over the open links of FreeSpace, so it
// passes no wall. A step shorter than a cell spreads the mass, which represents the speeds in
// between. A walk keeps its direction for about a second.
//
// A filter may narrow itself to a window of the room that holds nearly all of its mass; time and
// memory are then those of the window, whatever the size of the room. The rest of the mass is one
// number, away(): the target is outside. The window moves and grows with the mass. A filter may
// rest between two bursts: it then takes little memory at any window size.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "engine/base/timestamp.h"
#include "engine/grid/cell_set.h"
#include "engine/grid/cell_window.h"
#include "engine/track/free_space.h"

namespace rayloc {

struct MotionModel {
  std::vector<double> walking_speeds{0.5, 1.0};  // [m/s], a stroll and a brisk walk
  double direction_time = 1.0;                   // [s], mean duration of one direction of a walk
  double switching_rate = 0.5;                   // [1/s], rate from standing to walking and back
  // Odds of a walk when the channel has changed, and of standing when it has not.
  double change_odds = 10.0;
  // Probability that a burst carries no information on the position: a person blocks the path, or
  // the model is wrong there. It bounds how much one burst can rule out.
  double outlier = 0.02;
};

class GridFilter {
 public:
  // Uniform over all free cells, standing or walking with equal probability.
  // REQUIRES: at least one walking speed, all of them positive.
  GridFilter(std::shared_ptr<const FreeSpace> space, MotionModel motion);

  // Predicts over `elapsed`. REQUIRES: elapsed >= 0.
  void predict(Duration elapsed);

  // Change of the channel since the last measurement: 0 none, 1 as by a move.
  void weigh_change(double change);

  // Updates with the log-likelihood of every cell; `exponent` tempers it.
  void update(std::span<const double> log_likelihood, double exponent, double burst_outlier = 0.0);
  // The same for some cells that represent the room. Cells that were not compared get the mean
  // likelihood of the room.
  void update(std::span<const double> log_likelihood,
              const CellSet& cells,
              double exponent,
              double burst_outlier);

  // Narrows to the smallest window that leaves out at most `share` of the mass, extended by the
  // cells that a walk reaches within `reach`. Call before predict(reach).
  void narrow(double share, Duration reach);
  // Widens to the whole room: the mass of away() is spread over the other cells.
  void widen();
  const CellWindow& window() const { return window_; }
  double away() const { return away_; }  // probability

  // Keeps the masses of the `most` best cells of the window if it has more; the rest is spread
  // evenly over the others, mode by mode. Only wake() may be called next. `mass`: mass().
  void compact(std::size_t most, const std::vector<double>& mass);
  void wake();
  bool is_compact() const { return !kept_.cells.empty(); }

  std::vector<double> mass() const;  // [cell of window()], over all modes, sums to 1
  double stationary() const;         // probability of standing, for a target in the window

  // A mode of motion and its masses, valid until the filter changes.
  struct ModeView {
    double velocity_x = 0.0;  // [m/s]
    double velocity_y = 0.0;
    std::span<const float> mass;  // [cell of window()]
  };
  // The first mode is standing. REQUIRES: !is_compact().
  std::vector<ModeView> modes() const;
  // Replaces the state; the window is the room. mass: [mode][cell of the room], of any scale; that
  // of cells that are not free is ignored. REQUIRES: sizes of the modes and the room, a sum above 0
  // over the free cells.
  void set(const std::vector<std::vector<float>>& mass);

 private:
  struct Mode {
    double velocity_x = 0.0;  // [m/s]
    double velocity_y = 0.0;
    std::vector<float> mass;  // [cell of window_]
  };
  struct Relative {  // likelihoods relative to the mean of the free cells
    std::vector<double> of;
    double scale = 0.0;
  };

  // State of a resting filter.
  struct Kept {
    std::vector<std::uint32_t> cells;  // of window_, in order
    std::vector<float> mass;           // [mode][index in cells]
    std::vector<float> others;         // [mode], mass of every other free cell
  };

  double free_cells() const;
  void normalise();
  void change_modes(double seconds);
  void carry(Mode& mode, double seconds) const;
  void move_x(double share, std::vector<float>& mass) const;
  void move_y(double share, std::vector<float>& mass) const;
  void take(const CellWindow& window);
  Relative relative(std::span<const double> log_likelihood,
                    const CellSet& cells,
                    double exponent,
                    double outlier) const;

  std::shared_ptr<const FreeSpace> space_;
  MotionModel motion_;
  CellWindow window_;
  double away_ = 0.0;
  std::vector<Mode> modes_;  // the first is standing; without masses while the filter rests
  Kept kept_;                // empty: the filter is awake
};

}  // namespace rayloc
