#include "engine/localize/paper_position_loss.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "engine/base/check.h"
#include "engine/observe/alignment.h"

namespace rayloc {
namespace {

constexpr double kLeastResidual = 1e-30;

// What the surfaces that a path meets multiply it by.
Complex<double> correction_of(const Path& path, const RoomModel& room) {
  std::complex<double> factor = 1.0;
  for (const Interaction& interaction : path.interactions) {
    if (interaction.kind == InteractionKind::kReflection) {
      factor *= room.surface_correction[interaction.surface];
    }
  }
  return {factor.real(), factor.imag()};
}

std::vector<Paths> corrected(const std::vector<Paths>& traced, const RoomModel& room) {
  if (room.surface_correction.empty()) {
    return traced;
  }
  std::vector<Paths> result;
  for (const Paths& paths : traced) {
    std::vector<Path> changed(paths.begin(), paths.end());
    for (Path& path : changed) {
      path.a = correction_of(path, room) * path.a;
    }
    result.emplace_back(std::move(changed));
  }
  return result;
}

void correct(std::vector<PathDerivatives>& derivatives,
             const std::vector<Paths>& paths,
             const RoomModel& room) {
  if (room.surface_correction.empty()) {
    return;
  }
  for (std::size_t element = 0; element < paths.size(); ++element) {
    for (std::size_t i = 0; i < paths[element].size(); ++i) {
      const Complex<double> factor = correction_of(paths[element][i], room);
      for (std::size_t j = 0; j < derivatives[element].parameter_count(); ++j) {
        derivatives[element].at(i, j).a = factor * derivatives[element].at(i, j).a;
      }
    }
  }
}

Transmitter device_at(const RoomModel& room, const Vec3d& position) {
  return Transmitter{{position, {}, room.device.pattern, room.device.polarization}};
}

}  // namespace

PaperPositionLoss::PaperPositionLoss(const RoomModel& room,
                                     const PaperCsiLoss& csi_loss,
                                     std::span<const PaperMeasurement> measured,
                                     double centre_weight)
    : room_(room), csi_loss_(csi_loss), measured_(measured), centre_weight_(centre_weight) {
  RAYLOC_CHECK(!measured.empty());
}

std::vector<Paths> PaperPositionLoss::trace(const PaperStation& station,
                                            const Vec3d& position) const {
  return corrected(station.tracer.trace(device_at(room_, position)), room_);
}

LossInPlan PaperPositionLoss::of_station(const PaperMeasurement& measured,
                                         const Vec3d& position) const {
  static const std::array kInPlan = {Parameter::transmitter_position(0),
                                     Parameter::transmitter_position(1)};
  const ArrayTracer& tracer = measured.station->tracer;
  const Transmitter device = device_at(room_, position);
  const auto traced = tracer.trace(device);
  auto derivatives = tracer.differentiate(device, traced, kInPlan);
  RAYLOC_CHECK(derivatives.has_value());  // a position always has derivatives
  correct(*derivatives, traced, room_);
  const auto paths = corrected(traced, room_);
  const auto h = array_csi(paths, room_.grid);
  const auto expected = csi_loss_.observe(h);
  const auto gradient = array_loss_gradient(
      *derivatives, paths, room_.grid, csi_loss_.adjoint(measured.observables, expected, h));
  return {csi_loss_.value(measured.observables, expected), gradient[0], gradient[1]};
}

LossInPlan PaperPositionLoss::at(const Vec3d& position) const {
  const double x = position.x - 0.5 * (room_.bounds_min.x + room_.bounds_max.x);
  const double y = position.y - 0.5 * (room_.bounds_min.y + room_.bounds_max.y);
  LossInPlan sum{
      centre_weight_ * (x * x + y * y), 2.0 * centre_weight_ * x, 2.0 * centre_weight_ * y};
  const double share = 1.0 / static_cast<double>(measured_.size());
  for (const PaperMeasurement& measured : measured_) {
    const LossInPlan one = of_station(measured, position);
    sum.value += share * one.value;
    sum.by_x += share * one.by_x;
    sum.by_y += share * one.by_y;
  }
  return sum;
}

double PaperPositionLoss::model_residual_db(const Vec3d& position) const {
  const Aligner aligner(room_.grid);
  double residual = 0.0;
  for (const PaperMeasurement& measured : measured_) {
    const auto h = array_csi(trace(*measured.station, position), room_.grid);
    const bool is_silent = std::all_of(
        h.begin(), h.end(), [](const auto& value) { return value == std::complex<double>(); });
    residual += is_silent ? 1.0 : 1.0 - aligner.align(h, measured.h).correlation;
  }
  return 10.0 *
         std::log10(std::max(residual / static_cast<double>(measured_.size()), kLeastResidual));
}

bool PaperPositionLoss::is_reached(const Vec3d& position) const {
  return std::any_of(measured_.begin(), measured_.end(), [&](const PaperMeasurement& measured) {
    const auto paths = measured.station->tracer.trace(device_at(room_, position));
    return std::any_of(
        paths.begin(), paths.end(), [](const Paths& of_element) { return !of_element.empty(); });
  });
}

}  // namespace rayloc
