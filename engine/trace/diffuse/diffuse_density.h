// DiffuseDensity: the power that rough surfaces scatter from one antenna to another, by delay and
// angles: a sum over points of the surfaces, each representing the area about it.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/trace/diffuse/scattered_path.h"
#include "engine/trace/path.h"
#include "engine/trace/power_delay.h"

namespace rayloc {

// The contribution of one point, as Path is for a specular path; its phase is random.
struct DiffuseEcho {
  double power = 0.0;  // mean of |a|^2
  double tau = 0.0;    // [s]
  Vec3d departure;     // unit, world: direction of travel at the transmitter
  Vec3d arrival;       // unit, world: from the receiver towards the arriving wave
  ScatteringPatch patch;
  std::vector<Interaction> before;  // interactions before the patch, from the transmitter on
  std::vector<Interaction> after;   // interactions after the patch, from the receiver on
};

class DiffuseDensity {
 public:
  DiffuseDensity() = default;
  DiffuseDensity(std::vector<DiffuseEcho> echoes, double error)
      : echoes_(std::move(echoes)), error_(error) {}

  const std::vector<DiffuseEcho>& echoes() const { return echoes_; }
  // Power: the mean of |h|^2 over all realisations.
  PowerDelay power_delay() const;
  double power() const { return power_delay().power; }
  // Estimated error of the integration.
  double error() const { return error_; }
  // Power by delay: bin i begins at first + i * step [s]; power outside all bins is left out.
  std::vector<double> profile(double first, double step, std::size_t bins) const;

 private:
  std::vector<DiffuseEcho> echoes_;
  double error_ = 0.0;
};

// Derivatives of every echo by every parameter.
class DiffuseDerivatives {
 public:
  struct Derivative {
    double power = 0.0;  // d DiffuseEcho::power, per unit of the parameter
    double tau = 0.0;    // [s]
  };

  DiffuseDerivatives(std::size_t echoes, std::size_t parameters)
      : parameters_(parameters), values_(echoes * parameters) {}

  std::size_t parameter_count() const { return parameters_; }
  Derivative& at(std::size_t echo, std::size_t parameter) {
    return values_[echo * parameters_ + parameter];
  }
  const Derivative& at(std::size_t echo, std::size_t parameter) const {
    return values_[echo * parameters_ + parameter];
  }
  // d DiffuseDensity::power().
  double power(std::size_t parameter) const;

 private:
  std::size_t parameters_;
  std::vector<Derivative> values_;
};

}  // namespace rayloc
