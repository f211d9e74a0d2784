// GridFilter: a Bayes filter over the cells of a room for one target that stands or walks.
//
// METHODS B6. A mass per cell and mode of motion: one mode stands, the others walk in eight
// directions at two speeds. A walking mass moves over the open links of FreeSpace, so that it
// passes no wall; what a step carries only part of the way to the next cell spreads it, which
// stands for the speeds between. A walk keeps its direction for about a second.
//
// A filter may narrow itself to a window of the room that holds nearly all of its mass: it then
// costs and takes what the window does, whatever the size of the room. The rest of the mass is one
// number, away(), of a target that is anywhere else. The window moves and grows with the mass.
// Between two bursts a filter may rest: it then takes little memory, however wide its window is.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "engine/base/timestamp.h"
#include "engine/posterior/access_point_fusion.h"
#include "engine/track/cell_window.h"
#include "engine/track/free_space.h"

namespace rayloc {

struct MotionModel {
  std::vector<double> walking_speeds{0.5, 1.0};  // [m/s], a stroll and a brisk walk
  double direction_time = 1.0;                   // [s], for which a walk keeps its direction
  double switching_rate = 0.5;                   // [1/s], from standing to walking and back
  // Odds that a channel which has changed is one of a walk, and one that has not of a stand.
  double change_odds = 10.0;
  // Probability that a burst says nothing of the place: somebody is in the way, or the model is
  // wrong there. It bounds what one burst can rule out.
  double outlier = 0.02;
};

class GridFilter {
 public:
  // Everywhere that is free, standing or walking with equal probability.
  // REQUIRES: a walking speed, all of them positive.
  GridFilter(std::shared_ptr<const FreeSpace> space, MotionModel motion);

  // Time passes. REQUIRES: elapsed >= 0.
  void predict(Duration elapsed);

  // The channel has changed since the last measurement: 0 not at all, 1 as by a move.
  void weigh_change(double change);

  // What a burst says of every cell; `exponent` tempers it.
  void update(std::span<const double> log_likelihood, double exponent, double elsewhere = 0.0);
  // What it says of some cells that stand for the room. Of cells that it was not compared with it
  // says no more than of the room in the mean.
  struct Sampled {
    std::span<const double> log_likelihood;
    std::span<const std::size_t> cells;  // empty: all
    CellWeights weights;
  };
  void update(const Sampled& burst, double exponent, double elsewhere);

  // To the least window that leaves out no more than `share` of the mass, and beside it whatever a
  // walk reaches within `reach`. For predict(reach) to come.
  void narrow(double share, Duration reach);
  // To the whole room: the mass that is away is anywhere else in it.
  void widen();
  const CellWindow& window() const { return window_; }
  double away() const { return away_; }  // probability

  // Keeps the masses of the `most` best cells of the window, where it has more; the rest is spread
  // evenly over the others, mode by mode. Nothing but wake() until then. `mass`: mass().
  void rest(std::size_t most, const std::vector<double>& mass);
  void wake();
  bool is_resting() const { return !kept_.cells.empty(); }

  std::vector<double> mass() const;  // [cell of window()], of all modes, sums to 1
  double standing() const;           // probability, of a target in the window

 private:
  struct Mode {
    double velocity_x = 0.0;  // [m/s]
    double velocity_y = 0.0;
    std::vector<float> mass;  // [cell of window_]
  };
  struct Relative {  // likelihoods over the mean of the free cells
    std::vector<double> of;
    double scale = 0.0;
  };

  // What a resting filter keeps.
  struct Kept {
    std::vector<std::uint32_t> cells;  // of window_, in order
    std::vector<float> mass;           // [mode][of cells]
    std::vector<float> others;         // [mode], of every other cell that is free
  };

  double free_cells() const;
  void normalise();
  void change_modes(double seconds);
  void carry(Mode& mode, double seconds) const;
  void move_x(double share, std::vector<float>& mass) const;
  void move_y(double share, std::vector<float>& mass) const;
  void take(const CellWindow& window);
  Relative relative(const Sampled& burst, double exponent, double outlier) const;

  std::shared_ptr<const FreeSpace> space_;
  MotionModel motion_;
  CellWindow window_;
  double away_ = 0.0;
  std::vector<Mode> modes_;  // the first stands; without masses while it rests
  Kept kept_;                // empty: it is awake
};

}  // namespace rayloc
