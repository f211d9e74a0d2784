// The places of one cell of a room's grid, which a localizer looks at closely, as one figure.
#pragma once

#include <span>
#include <utility>

#include "engine/posterior/posterior.h"
#include "engine/room/lattice.h"

namespace rayloc {

// Places that fill a cell, NearbyLikelihood::kPlaceDistance of a wavelength [m] apart at most.
Lattice places_of_cell(const RoomGrid& grid, double wavelength);

// The logarithm of the mean of the places' tempered likelihoods, not tempered, and where their mass
// is; the best place has those beside it with it. `log_likelihood`: [place], of the lattice.
std::pair<double, CellMass> summarise_places(const Lattice& lattice,
                                             std::span<const double> log_likelihood,
                                             double likelihood_exponent);

// The places of a lattice at one height [m] (of RoomGrid::first): natural logarithms of their
// masses.
struct PlacesAtHeight {
  double height = 0.0;
  std::vector<double> log_mass;  // [place]
};
// The logarithm of the mass of all heights together, and where it is. REQUIRES: heights in order,
// equally far apart.
std::pair<double, CellMass> summarise_box(const Lattice& lattice,
                                          std::span<const PlacesAtHeight> heights);

// The same of masses that are no logarithms, [height][place]; their sum.
std::pair<double, CellMass> summarise_masses(const Lattice& lattice,
                                             std::span<const double> heights,
                                             std::span<const float> mass);

// Moments of a mixture; the shares are 1 in all.
struct WeightedMoments {
  double share = 0.0;
  CellMoments of;
};
CellMoments mixture_of(std::span<const WeightedMoments> parts);

}  // namespace rayloc
