// TrackedSearch: evaluates a burst of a device whose approximate position is known: the boxes (a
// cell and a layer of heights) that may hold it, at few places each, and the best of them at all of
// their places.
//
// Its cost depends on the uncertainty of the position, not on the size of the room.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/grid/cell_mass.h"
#include "engine/grid/grid.h"
#include "engine/grid/height_layers.h"
#include "engine/likelihood/ray_field.h"
#include "engine/localize/array_observation.h"
#include "engine/localize/local_refinement.h"
#include "engine/posterior/access_point_fusion.h"
#include "engine/posterior/room_map.h"

namespace rayloc {

class TrackedSearch {
 public:
  // The arguments must outlive it. REQUIRES: every map has_fields(); focus.cells is not empty.
  struct Room {
    const Grid& grid;
    double wavelength;  // [m]
    double likelihood_exponent;
  };
  TrackedSearch(const Room& room, std::vector<ArrayObservation> received, const SearchFocus& focus);

  // Share of the prior mass outside the evaluated boxes.
  double unevaluated_mass() const { return unevaluated_mass_; }

  // The evaluated cells, in ascending order; a subset of the focus.
  const std::vector<std::size_t>& cells() const { return cells_; }

  // [array][index in cells()]: log-likelihoods of each access point, relative to `null_model`.
  std::vector<std::vector<double>> scan(std::span<const double> null_model);
  // Removes an array that no place in the room explains.
  void leave_out(std::size_t array);
  // Joint likelihood of all access points; log_likelihood: for cells() first.
  void put_together(const AccessPointFusion& fusion, RoomMap& map) const;

 private:
  struct Box {
    std::size_t number = 0;  // index in cells_
    std::size_t layer = 0;
    double prior = 0.0;
  };
  struct Mass {
    double sum = 0.0;  // mean over the layer's places
    CellMass where;
  };
  struct Row {
    std::size_t x = 0;
    std::size_t y = 0;  // index of eight places
    std::size_t z = 0;
  };

  void choose_boxes(const SearchFocus& focus);
  void choose_rows();
  void evaluate_cell(std::size_t array, std::size_t first, std::size_t last, double null_model);
  double mean_of(std::size_t layer, std::span<const Row> rows, std::span<const LaneRow> mass) const;
  std::vector<LaneRow> all_places(const Box& box, const std::vector<FusedArray>& fused) const;
  Mass uniform(const Box& box, double sum) const;
  void put_cell(std::size_t first,
                std::size_t last,
                const std::vector<Mass>& masses,
                double log_scale,
                RoomMap& map) const;
  double above(std::size_t array, std::size_t cell, double null_model) const;

  const Room room_;
  std::vector<ArrayObservation> received_;
  std::vector<double> layer_weight_;
  FieldLattice lattice_;
  std::vector<std::vector<HeightSlice>> slices_;  // [layer]
  std::vector<Row> few_;                          // rows of places that are evaluated first
  std::vector<Row> all_;
  std::vector<std::size_t> cells_;
  std::vector<Box> boxes_;                    // ordered by cell
  double unevaluated_mass_ = 0.0;             // a probability
  std::size_t most_closely_ = 0;              // number of boxes evaluated at all their places
  std::vector<std::size_t> first_;            // [cell and the end], index in boxes_
  std::vector<double> null_model_;            // [array]
  std::vector<std::vector<LaneRow>> of_few_;  // [array][box][row]
  std::vector<float> highest_;                // [array]
};

// The same for a device at an unknown position: in the boxes of the best cells of a room's map.
void search_best_boxes(const TrackedSearch::Room& room,
                       const std::vector<ArrayObservation>& received,
                       std::span<const double> null_model,
                       const AccessPointFusion& fusion,
                       const SearchFocus& focus,
                       RoomMap& map);

}  // namespace rayloc
