#include "engine/localize/place_sample.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>

#include "engine/base/constants.h"
#include "engine/base/parallel.h"
#include "engine/grid/height_layers.h"
#include "engine/grid/lattice.h"
#include "engine/posterior/cell_places.h"

namespace rayloc {
namespace {

// A cell and a layer of heights, with the number of mass steps assigned to it.
struct SampleBox {
  std::size_t cell = 0;
  std::size_t layer = 0;
  std::size_t drawn = 0;
};

// Number of `count` equal steps of the mass that fall on each entry.
std::vector<std::size_t> draw(std::span<const double> log_mass, std::size_t count) {
  std::vector<std::size_t> drawn(log_mass.size());
  const double top = *std::max_element(log_mass.begin(), log_mass.end());
  double all = 0.0;
  for (const double one : log_mass) {
    all += std::exp(one - top);
  }
  double below = 0.0;
  std::size_t taken = 0;
  for (std::size_t i = 0; i < log_mass.size(); ++i) {
    below += std::exp(log_mass[i] - top) / all;
    while (taken < count &&
           (static_cast<double>(taken) + 0.5) / static_cast<double>(count) < below) {
      ++drawn[i];
      ++taken;
    }
  }
  return drawn;
}

std::vector<SampleBox> drawn_boxes(const Localizer& localizer,
                                   const Localizer::Evidence& evidence,
                                   std::size_t count) {
  std::vector<SampleBox> boxes;
  std::vector<double> log_mass;
  for (const auto& [cell, mass] : evidence.within) {
    const double whole = localizer.room().likelihood_exponent * evidence.log_likelihood[cell];
    for (std::size_t layer = 0; layer < localizer.grid().layers.size(); ++layer) {
      const double share = mass.layers.empty() ? 1.0 : static_cast<double>(mass.layers[layer]);
      if (share > 0.0) {
        boxes.push_back({cell, layer, 0});
        log_mass.push_back(whole + std::log(share));
      }
    }
  }
  if (boxes.empty()) {
    return boxes;
  }
  const std::vector<std::size_t> drawn = draw(log_mass, count);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    boxes[i].drawn = drawn[i];
  }
  std::erase_if(boxes, [](const SampleBox& box) { return box.drawn == 0; });
  return boxes;
}

std::vector<SampledPlace> places_in(const SampleBox& box,
                                    const Localizer& localizer,
                                    const RoomObservation& observation) {
  std::vector<std::unique_ptr<const BoxEvaluator>> evaluators;
  for (const ArrayObservation& array : observation.arrays) {
    evaluators.push_back(array.map->is_reachable(box.cell)
                             ? array.map->evaluator_at(box.cell, box.layer, array.observed)
                             : nullptr);
    if (evaluators.back() == nullptr) {
      return {};
    }
  }
  const HeightLayers& heights = localizer.grid().layers;
  const double wavelength = kSpeedOfLight / localizer.room().grid.centre_hz;
  const Lattice lattice = places_of_cell(localizer.grid(), wavelength);
  std::vector<Vec3d> places;
  std::vector<double> log_mass;
  for (const HeightSlice& slice : slices_of(heights,
                                            box.layer,
                                            localizer.grid().height_sigma,
                                            NearbyLikelihood::kHeightDistance * wavelength)) {
    const double above = slice.offset - heights.offset[box.layer];
    std::vector<double> sum(lattice.size());
    for (const auto& evaluator : evaluators) {
      const std::vector<double> values = evaluator->on(lattice, above);
      std::transform(sum.begin(), sum.end(), values.begin(), sum.begin(), std::plus<>());
    }
    for (std::size_t x = 0; x < lattice.count_x; ++x) {
      for (std::size_t y = 0; y < lattice.count_y; ++y) {
        places.push_back(lattice.offset(x, y) + Vec3d{0.0, 0.0, above});
        log_mass.push_back(localizer.room().likelihood_exponent * sum[x * lattice.count_y + y] +
                           std::log(slice.weight));
      }
    }
  }
  const std::vector<std::size_t> drawn = draw(log_mass, box.drawn);
  std::vector<SampledPlace> sample;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (drawn[i] > 0) {
      sample.push_back({box.cell, box.layer, places[i], static_cast<double>(drawn[i])});
    }
  }
  return sample;
}

}  // namespace

std::vector<SampledPlace> sample_places(const Localizer& localizer,
                                        const RoomObservation& observation,
                                        const Localizer::Evidence& evidence,
                                        std::size_t count) {
  const std::vector<SampleBox> boxes = drawn_boxes(localizer, evidence, count);
  std::vector<std::vector<SampledPlace>> in_each(boxes.size());
  parallel_for(boxes.size(), 1, [&](std::size_t i) {
    in_each[i] = places_in(boxes[i], localizer, observation);
  });
  std::vector<SampledPlace> sample;
  double drawn = 0.0;
  for (const std::vector<SampledPlace>& places : in_each) {
    for (const SampledPlace& place : places) {
      drawn += place.share;
      sample.push_back(place);
    }
  }
  for (SampledPlace& place : sample) {
    place.share /= drawn;
  }
  return sample;
}

}  // namespace rayloc
