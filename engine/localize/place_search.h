// PlaceSearch: compares one moment with single places of a room: the likelihood of a cloud.
//
// Places are grouped by their boxes (BoxLattice). Each box has one covariance, kept and shared by
// all devices; a place costs 0.2 to 0.6 microseconds per access point (`cloud_bench`), the less the
// more places a box has.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/likelihood/box/delay_rows.h"
#include "engine/likelihood/box/place_kernel.h"
#include "engine/localize/array_observation.h"
#include "engine/localize/box_lattice.h"
#include "engine/posterior/place_fusion.h"

namespace rayloc {

// Positions in a room with their boxes (BoxLattice::box_at, or kNone: not compared). Equal sizes.
struct SearchedPlaces {
  std::span<const float> x;  // [m], world
  std::span<const float> y;
  std::span<const float> z;  // ignored at a known height
  std::span<const std::uint32_t> box;
};

// The observation must outlive it. Single-threaded.
class PlaceSearch {
 public:
  // REQUIRES: can_search(observation).
  PlaceSearch(const RoomObservation& observation, double likelihood_exponent);
  static bool can_search(const RoomObservation& observation);  // every map has_place_boxes()

  static constexpr float kNotCompared = kNoMass;  // [nat]
  enum class Spread {
    kTogether,  // of one cloud
    kApart,     // boxes of the whole room
  };
  // [array][place], padded to a multiple of eight with the last value: log-likelihoods relative to
  // the null model, the received power included (that of the place's cell); the received power
  // alone in boxes that no ray reaches, kNotCompared where the box is kNone.
  //
  // kTogether: the box with most places is evaluated first. The delay is searched for in it and is
  // the hint for the others. kApart: each box has a search of its own. The obstructed case is
  // evaluated at every place: within a metre it fits some places and not others.
  // A value does not depend on the order of the places.
  std::vector<std::vector<float>> log_likelihoods(const SearchedPlaces& places, Spread spread);
  std::size_t boxes() const { return groups_.size(); }  // distinct ones of the last call

 private:
  struct Moment {  // of one access point
    const ArrayObservation* array = nullptr;
    DelayRows rows;
    int noise_class = 0;
    float null_model = 0.0F;
  };
  struct Group {  // places of one box, in order_ from `first` on
    std::uint32_t box = 0;
    std::size_t first = 0;
    std::size_t count = 0;
  };

  void group(const SearchedPlaces& places, const BoxLattice& lattice);
  std::size_t group_of(std::uint32_t box);
  // Index of the reachable box with most places; ties: the smallest number. groups_.size(): none.
  std::size_t fullest() const;
  void evaluate(const Moment& moment, Spread spread);
  void evaluate_box(const Moment& moment, std::size_t g, std::optional<std::size_t> hint);
  void take_values(const Moment& moment, const SearchedPlaces& places, std::vector<float>& out);

  double likelihood_exponent_;
  std::vector<Moment> moments_;
  std::vector<Group> groups_;         // in order of first appearance
  std::vector<std::uint32_t> table_;  // open addressing: a group, or kNone
  std::vector<std::size_t> order_;    // places by group
  std::vector<float> x_;              // [m], from the middle of the box, as order_
  std::vector<float> y_;
  std::vector<float> z_;
  std::vector<float> values_;                           // as order_
  std::vector<std::shared_ptr<const PlaceBox>> found_;  // [group], of one access point
  BoxBurst burst_;
};

}  // namespace rayloc
