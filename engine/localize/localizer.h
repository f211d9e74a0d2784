// Localizer: converts a burst of one transmitter, received by any number of access points, to a
// position with its uncertainty: a likelihood of METHODS B2 on a grid (METHODS B3, B7).
//
//   auto localizer = Localizer::create(room, {});
//   LocationEstimate estimate = localizer->locate(frames_of_one_transmitter);
//
// create() traces the grid of the room once (seconds); locate() takes milliseconds and depends on
// its arguments only: the same frames give the same bytes, whatever the number of threads.
//
// A tracker calls the two parts of locate() separately: receive(), then evidence() of the cells.
#pragma once

#include <complex>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "engine/base/expected.h"
#include "engine/channel/csi_frame.h"
#include "engine/grid/cell_mass.h"
#include "engine/grid/cell_set.h"
#include "engine/grid/grid.h"
#include "engine/likelihood/likelihood.h"
#include "engine/localize/access_point_map.h"
#include "engine/localize/array_observation.h"
#include "engine/localize/local_refinement.h"
#include "engine/localize/path_grid.h"
#include "engine/localize/search_area.h"
#include "engine/observe/burst.h"
#include "engine/posterior/access_point_fusion.h"
#include "engine/room/location_estimate.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct LocalizerOptions {
  LikelihoodKind likelihood = LikelihoodKind::kPartial;
  double accuracy_confidence = 0.95;
  std::size_t max_hypotheses = 5;
  BurstOptions burst;
  FaultPrior faults;
  // Stores the rays traced by create() for the next start; null: no store. Used by create() only.
  std::shared_ptr<PathGridStore> path_grids;
};

// Probability that frames carry no information on the position, in addition to what they reveal
// themselves: that the chains have new phase offsets (ChainLearner::fault_of()).
struct FrameFault {
  double probability = 0.0;
};

class Localizer {
 public:
  // An Error if the room cannot be modelled (no scene, empty room, no access point). An access
  // point without chain gains is left out, with a warning in every estimate.
  static Expected<Localizer> create(std::shared_ptr<const RoomModel> room,
                                    const LocalizerOptions& options);
  ~Localizer();
  Localizer(Localizer&&) noexcept;
  Localizer& operator=(Localizer&&) noexcept;

  // `frames`: one transmitter, any access points, in order of time. `fault` is added to the outlier
  // probability of the hypotheses.
  LocationEstimate locate(std::span<const CsiFrame> frames, const FrameFault& fault = {}) const;
  // With another exponent than RoomModel::likelihood_exponent: for fitting the exponent.
  LocationEstimate locate(std::span<const CsiFrame> frames, double likelihood_exponent) const;

  // kSingle: a single frame is not aligned to itself, and arrays that can be compared with places
  // (PlaceSearch) are preprocessed in single precision, in a tenth of the time (MomentProjection).
  enum class Precision { kDouble, kSingle };
  RoomObservation receive(std::span<const CsiFrame> frames,
                          Precision precision = Precision::kDouble) const;
  // Likelihoods of a burst for every cell of grid(). Cells far below the best have a less precise
  // value, a lower bound. REQUIRES: observation.arrays is not empty.
  enum class Scan {
    kCells,   // cells as a whole
    kPlaces,  // the best cells place by place, as locate() does
  };
  struct Evidence {
    // Relative to the null model, not tempered (the received-power term is divided by
    // RoomModel::likelihood_exponent, which does not apply to it); empty if no place explains the
    // burst.
    std::vector<double> log_likelihood;
    CellSet evaluated;     // of grid(), in the order of log_likelihood
    double outlier = 0.0;  // probability that the burst is uninformative
    RefinedCells within;   // distribution inside the best cells; empty with kCells
  };
  // `focus`: prior on the position. It selects the cells to evaluate, the cells to refine and the
  // heights, and is not part of the evidence.
  Evidence evidence(const RoomObservation& observation,
                    Scan scan = Scan::kCells,
                    const SearchFocus& focus = {}) const;
  // True if bursts can be compared with single places (PlaceSearch), whatever chains are dead.
  bool has_place_boxes() const;
  const SearchArea& area() const;
  const Grid& grid() const;  // of the calibrated area, with layers of heights

  const RoomModel& room() const;
  const LocalizerOptions& options() const;

 private:
  class Impl;
  explicit Localizer(std::unique_ptr<const Impl> impl);
  std::unique_ptr<const Impl> impl_;
};

}  // namespace rayloc
