// LayerWeights: the height of a target as a probability of each layer, the same at every position.
//
// All functions take the layers of the room's grid. Used by one thread at a time.
#pragma once

#include <utility>
#include <vector>

#include "engine/grid/cell_mass.h"
#include "engine/grid/cell_window.h"
#include "engine/grid/grid.h"
#include "engine/grid/height_layers.h"

namespace rayloc {

// The mass that cells of known inner distribution have in each layer, and their mass altogether.
struct LayerMass {
  std::vector<double> of_layer;
  double known = 0.0;
};
// mass: [cell of the window]. within: cells of the room's grid; those outside the window are left
// out.
LayerMass layer_mass_of(const RefinedCells& within,
                        const std::vector<double>& mass,
                        const CellWindow& window,
                        const Grid& grid);

class LayerWeights {
 public:
  // [layer], sum 1; empty: the height is known, or nothing more than its prior is.
  const std::vector<double>& weights() const { return weights_; }
  void set(std::vector<double> weights) { weights_ = std::move(weights); }
  void forget() { weights_.clear(); }

  // A carried target rises and sinks, occasionally by a large amount.
  struct Motion {
    double speed = 0.0;        // [m/s], vertical
    double change_rate = 0.0;  // [1/s], rate of changes to another height
  };
  void spread(const HeightLayers& heights, const Motion& motion, double seconds);

  // A burst of which only the share `weight` is new. REQUIRES: the height is not known.
  void learn(const HeightLayers& heights, const LayerMass& mass, double weight);

 private:
  std::vector<double> weights_;
};

}  // namespace rayloc
