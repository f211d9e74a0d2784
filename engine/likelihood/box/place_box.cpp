#include "engine/likelihood/box/place_box.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

#include "engine/base/check.h"
#include "engine/likelihood/box/box_factor.h"
#include "engine/likelihood/known_rays.h"

namespace rayloc {
namespace {

using Value = std::complex<double>;

constexpr double kBoxLeftOut = 1e-6;      // share of the known power, chosen: below any noise
constexpr double kMinClassNoise = 0.2;    // share of the model's noise, chosen: less is no class
constexpr int kClassOfModelNoise = 2;     // the class whose noise is that of the model
constexpr double kOctavesOfAClass = 2.0;  // from one class to the next: a factor of 4

void put_box_value(const Value& value, float* to) {
  to[0] = static_cast<float>(value.real());
  to[1] = static_cast<float>(value.imag());
}
void put_box_vector(const Vec3d& value, float* to) {
  to[0] = static_cast<float>(value.x);
  to[1] = static_cast<float>(value.y);
  to[2] = static_cast<float>(value.z);
}

// Fraction of a turn, in [0, 1).
double fraction_of(double turns) { return turns - std::floor(turns); }

// The images of one ray, from the middle of the box, and their lengths.
struct BoxImages {
  std::vector<Vec3d> at;       // [antenna], [m]
  std::vector<double> length;  // [antenna], [m]

  BoxImages(const Ray& ray, const ObservationModel::Place& place, const Vec3d& shift) {
    for (const Vec3d& offset : place.element_offset) {
      at.push_back(image_of(ray, offset) - Vec3d{shift.x, shift.y, 0.0});
      length.push_back(norm(at.back()));
    }
  }
  // k (e_m - e_0) [rad/m]
  Vec3d slope(std::size_t m, double wave_number) const {
    return wave_number * ((1.0 / length[m]) * at[m] - (1.0 / length[0]) * at[0]);
  }
};

// Largest phase of a slope at a corner of the box.
double phase_at_corner(const Vec3d& slope, const Vec3d& half) {
  return std::abs(slope.x) * half.x + std::abs(slope.y) * half.y + std::abs(slope.z) * half.z;
}

bool has_wide_slope(const std::vector<BoxImages>& rays, double wave_number, const Vec3d& half) {
  return std::any_of(rays.begin(), rays.end(), [&](const BoxImages& ray) {
    for (std::size_t m = 1; m < ray.at.size(); ++m) {
      if (phase_at_corner(ray.slope(m, wave_number), half) > static_cast<double>(kMaxSlopePhase)) {
        return true;
      }
    }
    return false;
  });
}

void put_image(const Vec3d& image, double phase, float* to) {
  put_box_vector(image, to);
  to[3] = static_cast<float>(dot(image, image));
  to[4] = static_cast<float>(phase);
}

// exp(-j k (l - first_length)) of rays at all antennas, [ray][antenna].
struct RayPhasors {
  std::vector<double> re;
  std::vector<double> im;

  // lengths: [m], [ray][antenna]
  RayPhasors(std::vector<double> lengths, double first_length, double turns_per_metre)
      : re(lengths.size()), im(lengths.size()) {
    for (double& length : lengths) {
      length = (length - first_length) * turns_per_metre;
    }
    unit_phasors(lengths, re, im);
  }
  Value at(std::size_t n) const { return {re[n], im[n]}; }
};

// From the place to the images, not moved to the middle of the box.
RayPhasors phasors_of_place(const ObservationModel::Place& place,
                            double first_length,
                            double turns_per_metre) {
  std::vector<double> lengths;
  for (const Ray& ray : place.rays) {
    const Vec3d at_array = ray.length * ray.at_array;
    for (const Vec3d& offset : place.element_offset) {
      lengths.push_back(norm(at_array - offset));
    }
  }
  return {std::move(lengths), first_length, turns_per_metre};
}
RayPhasors phasors_of_box(const std::vector<BoxImages>& rays,
                          double first_length,
                          double turns_per_metre) {
  std::vector<double> lengths;
  for (const BoxImages& ray : rays) {
    lengths.insert(lengths.end(), ray.length.begin(), ray.length.end());
  }
  return {std::move(lengths), first_length, turns_per_metre};
}

// a b, without std::complex's test for infinities.
Value product(const Value& a, const Value& b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

// phasors: of the antennas of this ray.
void put_ray(const BoxImages& ray,
             double wave_number,
             double phase,
             std::span<const Value> phasors,
             bool is_wide,
             float* to) {
  put_image(ray.at[0], phase, to);
  for (std::size_t m = 1; m < ray.at.size(); ++m) {
    to += PlaceBox::kAntennaFloats;
    if (is_wide) {
      put_image(ray.at[m], phase, to);
    } else {
      put_box_value(product(phasors[m], std::conj(phasors[0])), to);
      put_box_vector(ray.slope(m, wave_number), to + 2);
    }
  }
}

// Adds what is not in the mean: shares of the rays, the diffuse tail and noise.
void add_unknown(const ObservationModel& model,
                 const ObservationModel::Place& place,
                 const ModelError& error,
                 const ObservationModel::RayTerms& terms,
                 const std::vector<double>& shares,
                 BoxFactor& factor) {
  const std::size_t antennas = place.element_offset.size();
  const std::size_t size = factor.dimension();
  const std::size_t q = size / antennas;
  const std::size_t stride = BoxFactor::padded(size);
  const RayPhasors phasors =
      phasors_of_place(place, terms.first_length, model.wave_number() / (2.0 * std::numbers::pi));
  std::vector<double> re(stride * shares.size());
  std::vector<double> im(re.size());
  for (std::size_t p = 0; p < shares.size(); ++p) {
    const double scale = std::sqrt(shares[p]);
    for (std::size_t m = 0; m < antennas; ++m) {
      const Value phasor = scale * phasors.at(p * antennas + m);
      for (std::size_t i = 0; i < q; ++i) {
        const Value value = product(phasor, terms.tone[p * q + i]);
        re[p * stride + m * q + i] = value.real();
        im[p * stride + m * q + i] = value.imag();
      }
    }
  }
  factor.add(re, im);
  const double diffuse = diffuse_share(error, terms.first_length) / static_cast<double>(antennas);
  const std::vector<Value> tail = model.diffuse_covariance(error.diffuse_decay);
  for (std::size_t at = 0; at < size; at += q) {
    for (std::size_t i = 0; i < q; ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        factor.add(at + i, at + j, diffuse * tail[i * q + j]);
      }
      factor.add(at + i, at + i, error.noise / static_cast<double>(size));
    }
  }
}

// mean: mu of the middle.
void put_gaussian(const BoxFactor& factor, std::span<const Value> mean, PlaceBox& box) {
  float* to = box.whitener();
  for (std::size_t i = 0; i < factor.dimension(); ++i) {
    for (std::size_t j = 0; j <= i; ++j, to += 2) {
      put_box_value(factor.whitener(i, j), to);
    }
  }
  RAYLOC_CHECK(to == box.middle());
  for (const Value& value : factor.whiten(mean)) {
    put_box_value(value, to);
    to += 2;
  }
  box.log_determinant = static_cast<float>(factor.log_determinant());
}

}  // namespace

int noise_class_of(double burst_noise, double model_noise) {
  RAYLOC_CHECK(model_noise > 0.0);
  if (!(burst_noise >= kMinClassNoise * model_noise)) {
    return 0;
  }
  const double classes = std::log2(burst_noise / model_noise) / kOctavesOfAClass;
  return std::clamp(
      static_cast<int>(std::lround(classes)) + kClassOfModelNoise, 1, kNoiseClasses - 1);
}

double noise_of_class(int noise_class, double model_noise) {
  RAYLOC_CHECK(noise_class >= 0 && noise_class < kNoiseClasses);
  return noise_class == 0
             ? 0.0
             : model_noise * std::exp2(kOctavesOfAClass * (noise_class - kClassOfModelNoise));
}

std::size_t PlaceBox::floats_of(const Size& size) {
  const std::size_t dimension = size.antennas * size.coordinates;
  return size.rays * (kAntennaFloats * size.antennas + 2 * size.coordinates) +
         dimension * (dimension + 1) + 2 * dimension;
}

PlaceBox::PlaceBox(const Size& size) : size_(size), block_(floats_of(size)) {}

PlaceBox place_box(const ObservationModel& model,
                   const ObservationModel::Place& place,
                   const ModelError& error,
                   const BoxShape& shape,
                   std::size_t most_rays) {
  if (place.rays.empty()) {
    return {};
  }
  const std::size_t antennas = place.element_offset.size();
  const std::size_t q = model.dimension() / antennas;
  RAYLOC_CHECK(antennas <= kMaxBoxAntennas && model.dimension() <= kMaxBoxDimension &&
               most_rays <= kMaxBoxRays);
  const auto terms = model.ray_terms(place, error);
  const KnownRays known = known_rays(model, place, terms, most_rays, kBoxLeftOut);
  const double k = model.wave_number();
  std::vector<BoxImages> images;
  for (const std::size_t p : known.rays) {
    images.emplace_back(place.rays[p], place, shape.shift);
  }
  PlaceBox box({known.rays.size(), antennas, q});
  const double turns_per_metre = k / (2.0 * std::numbers::pi);
  const double phase = fraction_of(-terms.first_length * turns_per_metre);
  box.turns_per_metre = static_cast<float>(turns_per_metre);
  box.has_direct = known.has_direct;
  box.has_wide_slopes = has_wide_slope(images, k, shape.half);
  const RayPhasors phasors = phasors_of_box(images, terms.first_length, turns_per_metre);
  std::vector<Value> middle(model.dimension());
  std::vector<Value> of_ray(antennas);
  for (std::size_t n = 0; n < images.size(); ++n) {
    const std::size_t p = known.rays[n];
    for (std::size_t m = 0; m < antennas; ++m) {
      of_ray[m] = phasors.at(n * antennas + m);
    }
    put_ray(images[n], k, phase, of_ray, box.has_wide_slopes, box.ray(n));
    for (std::size_t i = 0; i < q; ++i) {
      const Value mean = terms.parts[p].known * terms.tone[p * q + i];
      put_box_value(mean, box.mean(n) + 2 * i);
      for (std::size_t m = 0; m < antennas; ++m) {
        middle[m * q + i] += product(mean, of_ray[m]);
      }
    }
  }
  BoxFactor factor(model.dimension());
  add_unknown(model, place, error, terms, unknown_shares(terms, known), factor);
  factor.factorise();
  put_gaussian(factor, middle, box);
  return box;
}

}  // namespace rayloc
