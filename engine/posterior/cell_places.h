// Summarises the refined places inside one cell of a room's grid as a single value.
#pragma once

#include <span>
#include <utility>

#include "engine/grid/cell_mass.h"
#include "engine/grid/grid.h"
#include "engine/grid/lattice.h"

namespace rayloc {

// Places that fill a cell, at most NearbyLikelihood::kPlaceDistance of a wavelength [m] apart.
Lattice places_of_cell(const Grid& grid, double wavelength);

// Logarithm of the mean tempered likelihood, divided by the exponent, and the distribution of mass;
// the best place includes its neighbours. `log_likelihood`: [place], of the lattice.
std::pair<double, CellMass> summarise_places(const Lattice& lattice,
                                             std::span<const double> log_likelihood,
                                             double likelihood_exponent);

// The places of a lattice at one height [m] (relative to Grid::first): natural logarithms of
// their masses.
struct PlacesAtHeight {
  double height = 0.0;
  std::vector<double> log_mass;  // [place]
};
// The logarithm of the total mass of all heights, and its distribution. REQUIRES: heights in
// ascending order, equally spaced.
std::pair<double, CellMass> summarise_box(const Lattice& lattice,
                                          std::span<const PlacesAtHeight> heights);

// The same for linear masses, [height][place]; returns their sum.
std::pair<double, CellMass> summarise_masses(const Lattice& lattice,
                                             std::span<const double> heights,
                                             std::span<const float> mass);

// Moments of a mixture; the shares add to 1.
struct WeightedMoments {
  double share = 0.0;
  CellMoments of;
};
CellMoments mixture_of(std::span<const WeightedMoments> parts);
// Moments of the mass of a cell that is not around its best place; those of all of it if there is
// no such mass.
CellMoments rest_of(const CellMass& cell);

}  // namespace rayloc
