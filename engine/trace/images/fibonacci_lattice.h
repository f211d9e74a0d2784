// FibonacciLattice: directions spread evenly over the sphere, in rings whose successive directions
// are neighbours on the sphere, so that rays shot in that order meet the same objects.
//
// Direction i of n has z = 1 - (2 i + 1) / n and i times the golden angle as azimuth. A ring is
// F successive directions, F a Fibonacci number; in steps of the Fibonacci number before F
// (modulo F) they are sorted by azimuth. F is chosen so that kTile directions in that order
// fill about a square.
//
// References: R. Swinbank, R. J. Purser, Q. J. R. Meteorol. Soc. 132 (2006) 1769.
#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

#include "engine/base/vec3.h"

namespace rayloc {

class FibonacciLattice {
 public:
  explicit FibonacciLattice(std::size_t size) : size_(size) {
    // A square of kTile directions on a ring of F: (2 pi / F) kTile = 2 F / size.
    const double target = std::sqrt(kTile * std::numbers::pi * static_cast<double>(size));
    while (static_cast<double>(ring_size_ + step_) < target) {
      step_ = std::exchange(ring_size_, ring_size_ + step_);
    }
  }

  std::size_t size() const { return size_; }
  std::size_t rings() const { return (size_ + ring_size_ - 1) / ring_size_; }

  // The directions of a ring, of length 1. Fills `directions`, whose memory is reused.
  // REQUIRES: ring < rings().
  void directions(std::size_t ring, std::vector<Vec3d>& directions) const {
    directions.clear();
    const std::size_t first = ring * ring_size_;
    double azimuth = kGoldenTurn * static_cast<double>(first);
    azimuth -= std::floor(azimuth);
    Turn now(azimuth);
    // Forwards within the ring, or back by its length: both a small part of a turn.
    const Turn forwards(kGoldenTurn * static_cast<double>(step_));
    const Turn wrapped(kGoldenTurn *
                       (static_cast<double>(step_) - static_cast<double>(ring_size_)));
    for (std::size_t count = 0, i = 0; count < ring_size_; ++count) {
      if (first + i < size_) {
        const double z =
            1.0 - static_cast<double>(2 * (first + i) + 1) / static_cast<double>(size_);
        const double across = std::sqrt(1.0 - z * z);
        directions.push_back({across * now.cosine, across * now.sine, z});
      }
      const bool wraps = i + step_ >= ring_size_;
      now = now * (wraps ? wrapped : forwards);
      i = wraps ? i + step_ - ring_size_ : i + step_;
    }
  }

 private:
  // A count of directions, chosen: neighbours meet the same objects.
  static constexpr double kTile = 16.0;
  static constexpr double kGoldenTurn = 2.0 - std::numbers::phi;  // the golden angle / 2 pi

  struct Turn {
    explicit Turn(double turns)
        : cosine(std::cos(2.0 * std::numbers::pi * turns)),
          sine(std::sin(2.0 * std::numbers::pi * turns)) {}
    Turn(double c, double s) : cosine(c), sine(s) {}
    friend Turn operator*(const Turn& a, const Turn& b) {
      return {a.cosine * b.cosine - a.sine * b.sine, a.sine * b.cosine + a.cosine * b.sine};
    }
    double cosine;
    double sine;
  };

  std::size_t size_;
  std::size_t ring_size_ = 1;  // F
  std::size_t step_ = 1;       // the Fibonacci number before it
};

}  // namespace rayloc
