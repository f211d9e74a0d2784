#include "engine/paper/person_loss.h"

#include <algorithm>
#include <cmath>

#include "engine/base/check.h"
#include "engine/observe/alignment.h"
#include "engine/paper/search.h"

namespace rayloc::paper {
PersonLoss::PersonLoss(const RoomModel& room,
                       const CsiLoss& csi_loss,
                       std::span<const PersonMeasurement> measured,
                       double centre_weight)
    : room_(room), csi_loss_(csi_loss), measured_(measured), centre_weight_(centre_weight) {
  RAYLOC_CHECK(!measured.empty());
}

std::vector<std::complex<double>> PersonLoss::channel(
    const UsableLink& link, const std::optional<std::vector<TargetPaths>>& added) const {
  auto h = link.empty;
  if (!added) {
    return h;
  }
  const std::size_t tones = room_.grid.size();
  for (std::size_t element = 0; element < added->size(); ++element) {
    const auto scattered = (*added)[element].paths.cfr(room_.grid);
    for (std::size_t k = 0; k < tones; ++k) {
      h[element * tones + k] += link.scale * scattered[k];
    }
  }
  return h;
}

LossInPlan PersonLoss::of_link(const PersonMeasurement& measured, const Vec3d& position) const {
  const UsableLink& link = *measured.link;
  const auto added = link.scattering.paths({position.x, position.y});
  const auto h = channel(link, added);
  const auto expected = csi_loss_.observe(h);
  LossInPlan loss{csi_loss_.value(measured.observables, expected), 0.0, 0.0};
  if (!added) {
    return loss;
  }
  // d value = Re sum conj(g) dh with dh = a d(dH): the factor moves to g.
  auto adjoint = csi_loss_.adjoint(measured.observables, expected, h);
  for (std::complex<double>& g : adjoint) {
    g *= std::conj(link.scale);
  }
  const std::size_t tones = room_.grid.size();
  for (std::size_t element = 0; element < added->size(); ++element) {
    const TargetPaths& of_element = (*added)[element];
    const auto gradient = of_element.by_position.loss_gradient(
        of_element.paths, room_.grid, std::span(adjoint).subspan(element * tones, tones));
    loss.by_x += gradient[0];
    loss.by_y += gradient[1];
  }
  return loss;
}

LossInPlan PersonLoss::at(const Vec3d& position) const {
  LossInPlan sum = centre_loss(room_, centre_weight_, position);
  const double share = 1.0 / static_cast<double>(measured_.size());
  for (const PersonMeasurement& measured : measured_) {
    const LossInPlan one = of_link(measured, position);
    sum.value += share * one.value;
    sum.by_x += share * one.by_x;
    sum.by_y += share * one.by_y;
  }
  return sum;
}

double PersonLoss::model_residual_db(const Vec3d& position) const {
  const Aligner aligner(room_.grid);
  double residual = 0.0;
  for (const PersonMeasurement& measured : measured_) {
    const UsableLink& link = *measured.link;
    const auto h = channel(link, link.scattering.paths({position.x, position.y}));
    residual += 1.0 - aligner.align(h, measured.h).correlation;
  }
  return 10.0 *
         std::log10(std::max(residual / static_cast<double>(measured_.size()), kMinResidual));
}

}  // namespace rayloc::paper
