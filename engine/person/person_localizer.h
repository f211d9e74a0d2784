// PersonLocalizer: position of a person, from the difference between a burst of a fixed
// transmitter's frames and the empty room (device-free; METHODS B5, B7).
//
//   auto localizer = PersonLocalizer::create(room, reference, {});
//   LocationEstimate estimate = localizer->locate(frames_of_the_fixed_transmitter);
//
// create() traces the room with a person at every place (seconds to a minute); locate() takes
// milliseconds and depends on its arguments alone.
//
// A tracker calls the two halves of locate() separately: receive(), then map().
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/base/expected.h"
#include "engine/channel/csi_frame.h"
#include "engine/grid/cell_mass.h"
#include "engine/grid/cell_set.h"
#include "engine/observe/burst.h"
#include "engine/person/person_cells.h"
#include "engine/person/person_likelihood.h"
#include "engine/person/person_reference.h"
#include "engine/person/person_scattering.h"
#include "engine/person/walkable_area.h"
#include "engine/room/location_estimate.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct PersonLocalizerOptions {
  double accuracy_confidence = 0.95;
  std::size_t max_hypotheses = 5;
  BurstOptions burst;
  double cell = 0.05;        // [m]
  int depth = kPersonDepth;  // reflections on the paths to and from the person together
};

// Received arrays, one entry for each link with usable frames.
struct PersonObservation {
  struct Array {
    std::size_t link = 0;  // of PersonReference::links
    PersonLikelihood::Observed observed;
    double weight = 1.0;  // of its log-likelihood; 1 when noise is negligible
  };
  std::vector<Array> arrays;
  LocationEstimate estimate;  // times, counts and warnings, no position
};

// Restrictions of a map; default: one person at any place.
struct PersonContext {
  // People at these places: the map is of one more person, clear of them, relative to the room with
  // these people only.
  std::span<const PersonSample> others{};
  std::optional<PersonSample> about{};  // only within 0.3 m of it
  // Cells to evaluate instead, which a person can occupy, and a sample of cells that represents the
  // rest of the room; empty: the whole room.
  std::span<const std::size_t> cells{};
  std::span<const std::size_t> sample{};
};

// Evidence of a burst on a person's place.
struct PersonMap {
  // For every cell, tempered, relative to the null model (no person there); far below 0 in cells
  // that no person can occupy and in cells that were not evaluated.
  std::vector<double> log_likelihood;
  // PersonContext::cells, if they are given, followed by its sample; all cells otherwise.
  CellSet evaluated;
  RefinedCells within;    // position within the best cells
  double presence = 0.0;  // log of the mean over the places that a person can occupy
  std::vector<std::string> warnings;
  bool is_explained = true;  // by a person at one of the places
  // The best place is right beside the transmitter, and several access points receive changes that
  // would be strong echoes from there: a moved or covered transmitter has the same effect.
  bool is_transmitter_suspect = false;
  // The best sample places, at least PersonMap::kApart from one another, the best first; the best
  // one's log-likelihood, over all arrays, up to a constant of the measurement; and its residual,
  // in units of the residual that the model expects: about 1.
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
  // `reason` states the cause; an empty room is such a cause.
  LocationEstimate locate(std::span<const CsiFrame> frames) const;
  // With another exponent of the likelihood than PersonModel::likelihood_exponent, for fitting the
  // exponent.
  LocationEstimate locate(std::span<const CsiFrame> frames, double likelihood_exponent) const;

  PersonObservation receive(std::span<const CsiFrame> frames) const;
  // REQUIRES: observation.arrays is not empty.
  PersonMap map(const PersonObservation& observation,
                double likelihood_exponent,
                const PersonContext& context = {}) const;
  // The estimate of receive() completed from a map: a fix, or the reason for none.
  LocationEstimate summarise(LocationEstimate estimate, const PersonMap& map) const;

  const WalkableArea& walkable_area() const;
  const RoomModel& room() const;
  const PersonReference& reference() const;
  const PersonLocalizerOptions& options() const;

 private:
  class Impl;
  explicit PersonLocalizer(std::unique_ptr<const Impl> impl);
  std::unique_ptr<const Impl> impl_;
};

// Log odds above which a person is accepted as present.
inline constexpr double kPresence = 3.0;
// Probability that a map has no information on the place (PosteriorOptions::outlier).
inline constexpr double kPersonOutlier = 0.02;

}  // namespace rayloc
