// PersonLocalizer: where a person stands, from what a burst of a fixed transmitter's frames differs
// from the empty room by (device-free; METHODS B5, B7).
//
//   auto localizer = PersonLocalizer::create(room, reference, {});
//   LocationEstimate estimate = localizer->locate(frames_of_the_fixed_transmitter);
//
// create() traces the room with a person everywhere (seconds to a minute); locate() costs
// milliseconds and depends on its arguments alone.
//
// A tracker takes the two halves of locate() apart: hear(), then map().
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/base/expected.h"
#include "engine/channel/csi_frame.h"
#include "engine/observe/burst.h"
#include "engine/person/person_likelihood.h"
#include "engine/person/person_reference.h"
#include "engine/person/person_scattering.h"
#include "engine/person/person_squares.h"
#include "engine/person/standing_room.h"
#include "engine/posterior/access_point_fusion.h"
#include "engine/posterior/posterior.h"
#include "engine/room/location_estimate.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct PersonLocalizerOptions {
  double accuracy_confidence = 0.95;
  std::size_t max_hypotheses = 5;
  BurstOptions burst;
  double cell = 0.05;        // [m]
  int depth = kPersonDepth;  // reflections on the ways to and from the person together
};

// What was heard, one entry for each link that heard something usable.
struct PersonObservation {
  struct Array {
    std::size_t link = 0;  // of PersonReference::links
    PersonLikelihood::Observed observed;
    double weight = 1.0;  // of its log-likelihood; 1 when noise is negligible
  };
  std::vector<Array> arrays;
  LocationEstimate estimate;  // times, counts and warnings, no position
};

// What a map is asked for beyond one person anywhere.
struct PersonContext {
  // People at these places: one more is looked for, who stands clear of them, against nobody but
  // them.
  std::span<const PersonSample> others{};
  std::optional<PersonSample> about{};  // only within 0.3 m of it
  // Cells to look at instead, where somebody can stand, and cells that stand for the others of the
  // room; empty: all of it.
  std::span<const std::size_t> cells{};
  std::span<const std::size_t> sample{};
};

// What a burst says of a person's place.
struct PersonMap {
  // Of every cell, tempered, against nobody being there; far below 0 where nobody can stand and
  // where nobody looked.
  std::vector<double> log_likelihood;
  // Those that were looked at, where PersonContext::cells says so, its sample behind them; empty:
  // all. How many each stands for.
  std::vector<std::size_t> cells;
  CellWeights weights;
  KnownCells within;      // where in the best cells
  double somebody = 0.0;  // logarithm of the mean over the places where somebody can stand
  std::vector<std::string> warnings;
  bool is_explained = true;  // by a person at one of the places
  // The best place is right beside the transmitter, and several access points hear what would be
  // strong echoes from there: a transmitter that was moved or covered looks the same.
  bool is_transmitter_doubtful = false;
  // The best sample places, at least PersonMap::kApart from one another, the best first; how likely
  // that is, over all arrays, up to a constant of the measurement; and what it leaves unexplained,
  // in units of what the model expects to: about 1.
  static constexpr double kApart = 0.3;      // [m]
  static constexpr std::size_t kPlaces = 4;  // a count of places, at most
  std::vector<PersonSample> places;
  double best_log_likelihood = 0.0;
  double misfit = 1.0;
};

class PersonLocalizer {
 public:
  // An Error when the room, the reference or the body cannot be used.
  static Expected<PersonLocalizer> create(std::shared_ptr<const RoomModel> room,
                                          PersonReference reference,
                                          const PersonLocalizerOptions& options);
  ~PersonLocalizer();
  PersonLocalizer(PersonLocalizer&&) noexcept;
  PersonLocalizer& operator=(PersonLocalizer&&) noexcept;

  // `frames`: of the reference's transmitter, any access points, in order of time. Without a fix,
  // `reason` says why; an empty room is such a reason.
  LocationEstimate locate(std::span<const CsiFrame> frames) const;
  // With another exponent of the likelihood than PersonModel::likelihood_exponent: for fitting
  // that.
  LocationEstimate locate(std::span<const CsiFrame> frames, double likelihood_exponent) const;

  PersonObservation hear(std::span<const CsiFrame> frames) const;
  // REQUIRES: observation.arrays is not empty.
  PersonMap map(const PersonObservation& observation,
                double likelihood_exponent,
                const PersonContext& context = {}) const;
  // The estimate of hear() with what a map says: a fix, or why there is none.
  LocationEstimate summarise(LocationEstimate estimate, const PersonMap& map) const;

  const StandingRoom& standing_room() const;
  const RoomModel& room() const;
  const PersonReference& reference() const;
  const PersonLocalizerOptions& options() const;

 private:
  class Impl;
  explicit PersonLocalizer(std::unique_ptr<const Impl> impl);
  std::unique_ptr<const Impl> impl_;
};

// Logarithm of the odds from which on somebody is believed to be there.
inline constexpr double kSomebody = 3.0;
// Probability that a map says nothing of the place (PosteriorOptions::outlier).
inline constexpr double kPersonOutlier = 0.02;

}  // namespace rayloc
