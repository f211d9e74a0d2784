#include "engine/paper/position_loss.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/check.h"
#include "engine/observe/alignment.h"
#include "engine/paper/search.h"
#include "engine/room/surface_correction.h"

namespace rayloc::paper {
namespace {

Transmitter device_at(const RoomModel& room, const Vec3d& position) {
  return Transmitter{{position, {}, room.device.pattern, room.device.polarization}};
}

}  // namespace

PositionLoss::PositionLoss(const RoomModel& room,
                           const CsiLoss& csi_loss,
                           std::span<const Measurement> measured,
                           double centre_weight)
    : room_(room), csi_loss_(csi_loss), measured_(measured), centre_weight_(centre_weight) {
  RAYLOC_CHECK(!measured.empty());
}

std::vector<Paths> PositionLoss::trace(const UsableAccessPoint& ap, const Vec3d& position) const {
  auto traced = ap.tracer.trace(device_at(room_, position));
  for (Paths& paths : traced) {
    correct_paths(room_.surface_correction, paths);
  }
  return traced;
}

LossInPlan PositionLoss::of_access_point(const Measurement& measured, const Vec3d& position) const {
  // [m], x and y: the method keeps the height constant (METHODS A4).
  static const std::array kInPlan = {Parameter::transmitter_position(0),
                                     Parameter::transmitter_position(1)};
  const ArrayTracer& tracer = measured.ap->tracer;
  const Transmitter device = device_at(room_, position);
  auto paths = tracer.trace(device);
  auto derivatives = tracer.differentiate(device, paths, kInPlan);
  RAYLOC_CHECK(derivatives.has_value());  // derivatives by a position always exist
  for (std::size_t element = 0; element < paths.size(); ++element) {
    correct_paths(room_.surface_correction, paths[element], (*derivatives)[element]);
  }
  const auto h = array_csi(paths, room_.grid);
  const auto expected = csi_loss_.observe(h);
  const auto gradient = array_loss_gradient(
      *derivatives, paths, room_.grid, csi_loss_.adjoint(measured.observables, expected, h));
  return {csi_loss_.value(measured.observables, expected), gradient[0], gradient[1]};
}

LossInPlan PositionLoss::at(const Vec3d& position) const {
  LossInPlan sum = centre_loss(room_, centre_weight_, position);
  const double share = 1.0 / static_cast<double>(measured_.size());
  for (const Measurement& measured : measured_) {
    const LossInPlan one = of_access_point(measured, position);
    sum.value += share * one.value;
    sum.by_x += share * one.by_x;
    sum.by_y += share * one.by_y;
  }
  return sum;
}

double PositionLoss::model_residual_db(const Vec3d& position) const {
  const Aligner aligner(room_.grid);
  double residual = 0.0;
  for (const Measurement& measured : measured_) {
    const auto h = array_csi(trace(*measured.ap, position), room_.grid);
    const bool is_silent = std::all_of(
        h.begin(), h.end(), [](const auto& value) { return value == std::complex<double>(); });
    residual += is_silent ? 1.0 : 1.0 - aligner.align(h, measured.h).correlation;
  }
  return 10.0 *
         std::log10(std::max(residual / static_cast<double>(measured_.size()), kMinResidual));
}

bool PositionLoss::is_reached(const Vec3d& position) const {
  return std::any_of(measured_.begin(), measured_.end(), [&](const Measurement& measured) {
    const auto paths = measured.ap->tracer.trace(device_at(room_, position));
    return std::any_of(
        paths.begin(), paths.end(), [](const Paths& of_element) { return !of_element.empty(); });
  });
}

}  // namespace rayloc::paper
