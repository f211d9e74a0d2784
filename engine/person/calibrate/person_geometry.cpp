#include "engine/person/calibrate/person_geometry.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "engine/base/parallel.h"
#include "engine/person/calibrate/offset_cube.h"

namespace rayloc {
namespace {

using Value = std::complex<double>;

constexpr PatchPlan kPlan{0.0, 0.0, 0.042, 7};  // about a known place
constexpr int kGeometryPhases = 24;             // a count, chosen: 15 degrees apart
// Ratios to a body's wave, chosen: 2 to 3 dB apart.
constexpr std::array<double, 5> kGeometryLevels = {0.5, 0.7, 0.9, 1.1, 1.4};
constexpr double kGeometryLevelSigma = 0.3;  // of the logarithm of the amplitude
constexpr double kCoarse = 0.005;            // [m], step of the scan of the transmitter's place
constexpr int kCoarseSteps = 3;              // on each side
constexpr double kFine = 0.001;              // [m], last step of the search
// Errors of a person's rays while the geometry is unknown.
constexpr double kVariance = 0.3;
constexpr double kGeometryDiffuse = 0.3;  // a ratio, as PersonModel::diffuse
constexpr double kGeometryNoise = 1e-3;   // a ratio, as PersonModel::noise

// A point as received by one link.
struct WhitenedPoint {
  std::size_t number = 0;
  ScatteredRays rays;
  WhitenedGaussian errors;
  std::vector<Value> y;      // whitened, empty room projected out
  std::vector<Value> empty;  // whitened, unit
};

void take_out(const std::vector<Value>& unit, std::vector<Value>& x) {
  Value along;
  for (std::size_t i = 0; i < x.size(); ++i) {
    along += std::conj(unit[i]) * x[i];
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] -= along * unit[i];
  }
}

class GeometryLink {
 public:
  GeometryLink(const RoomModel& room, const PersonReference& reference, std::size_t number)
      : link_(reference.links[number]),
        number_(number),
        likelihood_(room.grid,
                    room.access_points[link_.access_point].rx_chains.size(),
                    link_,
                    norm(room.access_points[link_.access_point].array.pose.position -
                         reference.transmitter.position)) {}

  Expected<void> trace(const RoomModel& room,
                       const PersonReference& reference,
                       std::span<const PersonPoint> points,
                       const TargetBody& body,
                       int depth) {
    const auto scattering =
        PersonScattering::create(room, link_.access_point, reference.transmitter, body, depth);
    RAYLOC_TRY(scattering);
    PersonModel model = reference.person;
    model.strength_variance = kVariance;
    model.diffuse = kGeometryDiffuse;
    model.noise = kGeometryNoise;
    std::vector<std::optional<WhitenedPoint>> found(points.size());
    parallel_for(points.size(), 1, [&](std::size_t s) {
      if (points[s].h[number_].empty()) {
        return;
      }
      auto rays = scattering->at(points[s].place);
      if (!rays) {
        return;
      }
      WhitenedPoint point;
      point.number = s;
      point.rays = *std::move(rays);
      point.errors = likelihood_.place(likelihood_.patch(point.rays, kPlan), 1.0, model).close;
      point.empty = whiten(point.errors, likelihood_.empty());
      double power = 0.0;
      for (const Value& v : point.empty) {
        power += std::norm(v);
      }
      for (Value& v : point.empty) {
        v /= std::sqrt(power);
      }
      const auto observed = likelihood_.observe(points[s].h[number_]);
      point.y = whiten(point.errors, observed.y[PersonLikelihood::kDelays / 2]);
      take_out(point.empty, point.y);
      found[s] = std::move(point);
    });
    points_.clear();
    for (auto& one : found) {
      if (one) {
        points_.push_back(*std::move(one));
      }
    }
    return {};
  }

  std::size_t points() const { return points_.size(); }

  // Log-likelihood of all points at the best complex factor, with the transmitter moved.
  double log_likelihood(const Vec3d& shift, std::span<const double> prior) const {
    std::vector<double> along_re;
    std::vector<double> along_im;
    std::vector<double> power;
    for (const WhitenedPoint& point : points_) {
      const auto patch = likelihood_.patch(moved_transmitter(point.rays, shift), kPlan);
      const std::size_t size = likelihood_.dimension();
      for (std::size_t p = 0; p < prior.size(); ++p) {
        const auto first = patch.sample.begin() + static_cast<std::ptrdiff_t>(p * size);
        auto z = whiten(point.errors,
                        std::vector<Value>(first, first + static_cast<std::ptrdiff_t>(size)));
        take_out(point.empty, z);
        Value along;
        double z_power = 0.0;
        for (std::size_t i = 0; i < size; ++i) {
          along += std::conj(z[i]) * point.y[i];
          z_power += std::norm(z[i]);
        }
        along_re.push_back(along.real());
        along_im.push_back(along.imag());
        power.push_back(z_power);
      }
    }
    double best = -std::numeric_limits<double>::infinity();
    for (const double level : kGeometryLevels) {
      const double off = std::log(level) / kGeometryLevelSigma;
      for (int i = 0; i < kGeometryPhases; ++i) {
        const Value a = std::polar(level, 2.0 * std::numbers::pi * i / kGeometryPhases);
        double sum = -0.5 * off * off;
        for (std::size_t s = 0; s < points_.size(); ++s) {
          double top = -std::numeric_limits<double>::infinity();
          std::array<double, kPlan.count * kPlan.count> value{};
          for (std::size_t p = 0; p < prior.size(); ++p) {
            const std::size_t n = s * prior.size() + p;
            value.at(p) = prior[p] + 2.0 * (a.real() * along_re[n] + a.imag() * along_im[n]) -
                          level * level * power[n];
            top = std::max(top, value.at(p));
          }
          double mass = 0.0;
          for (const double v : value) {
            mass += std::exp(v - top);
          }
          sum += top + std::log(mass);
        }
        best = std::max(best, sum);
      }
    }
    return best;
  }

 private:
  const PersonLink& link_;
  std::size_t number_;
  PersonLikelihood likelihood_;
  std::vector<WhitenedPoint> points_;
};

class GeometryFit {
 public:
  explicit GeometryFit(const PersonFitOptions& options) : options_(options) {
    const double scale = -0.5 / (options.place_sigma * options.place_sigma);
    for (std::size_t i = 0; i < kPlan.count; ++i) {
      for (std::size_t j = 0; j < kPlan.count; ++j) {
        prior_.push_back(scale * (kPlan.at(i) * kPlan.at(i) + kPlan.at(j) * kPlan.at(j)));
      }
    }
  }

  double value(const std::vector<GeometryLink>& links, const Vec3d& shift) const {
    double sum =
        -0.5 * dot(shift, shift) / (options_.transmitter_sigma * options_.transmitter_sigma);
    for (const GeometryLink& link : links) {
      sum += link.log_likelihood(shift, prior_);
    }
    return sum;
  }

  struct Best {
    Vec3d shift;
    double value = -std::numeric_limits<double>::infinity();
  };

  Best scan(const std::vector<GeometryLink>& links) const {
    const OffsetCube cube(kCoarseSteps);
    std::vector<double> values(cube.size());
    const auto shift = [&](std::size_t n) { return kCoarse * cube[n]; };
    parallel_for(values.size(), 1, [&](std::size_t n) { values[n] = value(links, shift(n)); });
    const auto best =
        static_cast<std::size_t>(std::max_element(values.begin(), values.end()) - values.begin());
    return {shift(best), values[best]};
  }

  // Searches along the axes in turn, with decreasing steps.
  Best refine(const std::vector<GeometryLink>& links, Best best) const {
    double step = 0.5 * kCoarse;
    while (step > 0.5 * kFine) {
      for (bool better = true; better;) {
        better = false;
        for (const Vec3d& axis : {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}}) {
          for (const double sign : {-1.0, 1.0}) {
            const Vec3d shift = best.shift + sign * step * axis;
            const double there = value(links, shift);
            if (there > best.value) {
              best = {shift, there};
              better = true;
            }
          }
        }
      }
      step *= 0.5;
    }
    return best;
  }

 private:
  const PersonFitOptions& options_;
  std::vector<double> prior_;
};

}  // namespace

Expected<PersonGeometry> fit_person_geometry(const RoomModel& room,
                                             const PersonReference& reference,
                                             std::span<const PersonPoint> points,
                                             const PersonFitOptions& options) {
  const GeometryFit fit(options);
  std::vector<GeometryLink> links;
  for (std::size_t l = 0; l < reference.links.size(); ++l) {
    links.emplace_back(room, reference, l);
  }
  PersonGeometry geometry{{}, reference.person.body.semi_axes[0]};
  GeometryFit::Best best;
  for (const double step : options.radius_steps) {
    TargetBody body = reference.person.body;
    const double radius = body.semi_axes[0] + step;
    if (radius < options.least_radius) {
      continue;
    }
    body.semi_axes = {radius, radius};
    for (GeometryLink& link : links) {
      RAYLOC_TRY(link.trace(room, reference, points, body, options.depth));
    }
    // The transmitter's place does not depend on the radius: it is scanned only once.
    auto here = std::isfinite(best.value)
                    ? GeometryFit::Best{best.shift, fit.value(links, best.shift)}
                    : fit.scan(links);
    here = fit.refine(links, here);
    const double off = step / options.radius_sigma;
    here.value -= 0.5 * off * off;
    if (here.value > best.value) {
      best = here;
      geometry = {here.shift, radius};
    }
  }
  return geometry;
}

}  // namespace rayloc
