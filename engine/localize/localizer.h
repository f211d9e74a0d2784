// Localizer: from a burst of frames of one transmitter, heard by any number of access points, to a
// position with its uncertainty: a likelihood of METHODS B2 on a grid of the room (METHODS B3, B7).
//
//   auto localizer = Localizer::create(room, {});
//   LocationEstimate estimate = localizer->locate(frames_of_one_transmitter);
//
// create() traces the grid of the room once (seconds); locate() costs milliseconds and depends on
// its arguments alone: the same frames give the same bytes, whatever the number of threads.
//
// A tracker takes the two halves of locate() apart: hear(), then log_likelihood() of every cell.
#pragma once

#include <complex>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "engine/base/expected.h"
#include "engine/channel/csi_frame.h"
#include "engine/likelihood/likelihood.h"
#include "engine/localize/access_point_map.h"
#include "engine/localize/close_search.h"
#include "engine/localize/heard_array.h"
#include "engine/localize/path_grid.h"
#include "engine/localize/watched_area.h"
#include "engine/observe/burst.h"
#include "engine/posterior/access_point_fusion.h"
#include "engine/posterior/posterior.h"
#include "engine/room/location_estimate.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct LocalizerOptions {
  LikelihoodKind likelihood = LikelihoodKind::kPartial;
  double accuracy_confidence = 0.95;
  std::size_t max_hypotheses = 5;
  BurstOptions burst;
  FaultPrior faults;
  // Keeps what create() traces for the next time; null: nothing is kept. Used by create() alone.
  std::shared_ptr<PathGridStore> path_grids;
};

// Probability that frames say nothing of the place, beside what they show themselves: that the
// chains have turned (ChainLearner::doubt()).
struct FrameDoubt {
  double probability = 0.0;
};

class Localizer {
 public:
  // An Error when the room cannot be modelled at all (no scene, empty room, no access point).
  // An access point without chain gains is left out, with a warning in every estimate.
  static Expected<Localizer> create(std::shared_ptr<const RoomModel> room,
                                    const LocalizerOptions& options);
  ~Localizer();
  Localizer(Localizer&&) noexcept;
  Localizer& operator=(Localizer&&) noexcept;

  // `frames`: one transmitter, any access points, in order of time.
  // What is doubted is left over, beside what the hypotheses state.
  LocationEstimate locate(std::span<const CsiFrame> frames, const FrameDoubt& doubt = {}) const;
  // With another exponent of the likelihood than RoomModel::likelihood_exponent: for fitting that.
  LocationEstimate locate(std::span<const CsiFrame> frames, double likelihood_exponent) const;

  RoomObservation hear(std::span<const CsiFrame> frames) const;
  // What a burst says of every cell of grid(). Cells that are far from the best are known less
  // precisely, as a lower bound. REQUIRES: observation.arrays is not empty.
  enum class Look {
    kCells,   // as a whole
    kPlaces,  // the best of them place by place, as locate() does
  };
  struct Evidence {
    // Relative to the device being nowhere in particular, not tempered (what a level says is
    // divided by RoomModel::likelihood_exponent, which does not apply to it); empty when no place
    // explains the burst.
    std::vector<double> log_likelihood;
    // Those that it is of, where the focus says where to look; empty: all of grid().
    std::vector<std::size_t> cells;
    CellWeights weights;
    double elsewhere = 0.0;  // probability that the burst says nothing of the place
    KnownCells within;       // where in the best cells; empty with kCells
  };
  // `focus`: what is known of the place before the burst; it says where to look, where to look
  // closely and how high the device may be, and is not in the evidence.
  Evidence evidence(const RoomObservation& observation,
                    Look look = Look::kCells,
                    const SearchFocus& focus = {}) const;
  const WatchedArea& area() const;
  const RoomGrid& grid() const;  // of the area
  const HeightLayers& heights() const;

  const RoomModel& room() const;
  const LocalizerOptions& options() const;

 private:
  class Impl;
  explicit Localizer(std::unique_ptr<const Impl> impl);
  std::unique_ptr<const Impl> impl_;
};

}  // namespace rayloc
