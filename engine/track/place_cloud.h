// PlaceCloud: the state of a target as weighted places, each with a velocity: a particle filter in
// which only the path is drawn. Given its path, a velocity is Gaussian, so each place has a mean
// velocity and a variance instead of a drawn one (Rao-Blackwellised).
//
// Positions are those of the world [m]. A place either rests or walks. Nothing here depends on
// radio: the caller multiplies the weights, and removes impossible places. Results follow from
// the arguments alone; a cloud is used by one thread at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/normal_draws.h"
#include "engine/base/vec3.h"
#include "engine/grid/grid.h"
#include "engine/grid/height_layers.h"

namespace rayloc {

struct CloudMotion {
  double acceleration = 0.5;         // [m^2/s^3], spectral density of the acceleration of a walk
  double turn_share = 0.2;           // probability that a step has a turn, a start or a stop ...
  double turn_factor = 10.0;         // ... with this multiple of the spectral density
  double velocity_time = 2.0;        // [s], time constant of the decay of a velocity
  double speed = 0.6;                // [m/s], deviation of each component when a walk begins
  double switching_rate = 0.5;       // [1/s], between walk and rest
  double rest_jitter = 0.002;        // [m], in 1 s, of a place that rests
  double height_speed = 0.1;         // [m/s], of a place that walks
  double height_change_rate = 0.05;  // [1/s], rate at which its height is drawn from the prior
  // [m], deviation of the move of a place that is drawn again; 0.3 of it at rest.
  Vec3d resampled{0.003, 0.003, 0.006};
};

struct CloudPlace {
  float x = 0.0F;  // [m]
  float y = 0.0F;
  float z = 0.0F;
  float u = 0.0F;         // [m/s], mean velocity in x ...
  float v = 0.0F;         // ... and in y
  float variance = 0.0F;  // [m^2/s^2], of each component of the velocity
  bool is_resting = false;
};

class PlaceCloud {
 public:
  static constexpr float kNoWeight = -1e30F;  // log-weight of an impossible place

  std::size_t size() const { return x_.size(); }
  void reserve(std::size_t count);
  // log_weight: relative to the other places, of any scale.
  void add(const CloudPlace& place, float log_weight);
  CloudPlace place(std::size_t i) const;
  std::span<const float> x() const { return x_; }
  std::span<const float> y() const { return y_; }
  std::span<const float> z() const { return z_; }
  std::span<const float> u() const { return u_; }
  std::span<const float> v() const { return v_; }
  std::span<const float> log_weight() const { return log_weight_; }

  // Predicts over `seconds`. height: the prior; with sigma 0 the height is known, and z is fixed.
  // REQUIRES: seconds >= 0.
  void predict(double seconds,
               const CloudMotion& motion,
               const HeightPrior& height,
               NormalDraws& draws);
  // The place has no weight; the next resample() replaces it.
  void remove(std::size_t i) { log_weight_[i] = kNoWeight; }

  // Change of the channel since the last moment: 0 none, 1 as by a move; `odds` as
  // MotionModel::change_odds.
  void weigh_change(double change, double odds);
  // Multiplies the weights by factors >= 0, at least size() of them, and scales their sum to 1.
  // Returns ln of the mean factor; -inf if all weights vanish: then they do not change.
  double weigh(std::span<const float> factor);

  double effective() const;  // effective number of places
  // Draws `count` places of equal weight in equal steps of the weight, and moves each a little.
  // False if all weights vanish: then nothing changes.
  bool resample(std::size_t count,
                const CloudMotion& motion,
                bool is_height_known,
                NormalDraws& draws);

  double resting() const;              // probability of rest
  std::vector<float> weights() const;  // [place], sum 1; all 0 if all weights vanish

 private:
  struct Step;

  void walk(std::size_t i, const Step& step, bool has_turn, NormalDraws& draws);

  std::vector<float> x_;  // [place], as CloudPlace
  std::vector<float> y_;
  std::vector<float> z_;
  std::vector<float> u_;
  std::vector<float> v_;
  std::vector<float> variance_;
  std::vector<std::uint8_t> is_resting_;
  std::vector<float> log_weight_;
};

// The cell of place i in plan; grid.size() outside the grid.
std::size_t cell_of(const PlaceCloud& cloud, std::size_t i, const Grid& grid);

}  // namespace rayloc
