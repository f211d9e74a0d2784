// PersonCells: likelihood models of every access point for a person at every place of the room
// that a person can occupy. Traced once; localization is then a table look-up.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/base/expected.h"
#include "engine/base/vec3.h"
#include "engine/grid/lattice.h"
#include "engine/person/person_likelihood.h"
#include "engine/person/person_reference.h"
#include "engine/person/person_scattering.h"
#include "engine/person/walkable_area.h"
#include "engine/room/room_model.h"

namespace rayloc {

// One of the sample places of a cell (PatchPlan).
struct PersonSample {
  std::size_t cell = 0;
  std::size_t sample = 0;
};

// One access point of the reference.
struct PersonLinkMap {
  PersonLikelihood likelihood;
  PersonScattering scattering;
  std::vector<PersonPlace> cells;  // empty where no person fits
  PersonGaussian no_person;
  std::vector<PersonGaussian> changed;  // the room, changed but not by a person, by some shares
};

struct PersonCells {
  WalkableArea walkable;
  std::size_t samples = 0;           // along the side of a cell
  std::vector<PersonLinkMap> links;  // one per link of the reference

  Lattice lattice() const;                           // of the sample places of a cell
  Vec3d place_of(const PersonSample& sample) const;  // [m], on the floor
};

// An Error when reference, access point or body cannot be used. `cell` [m], approximate; `depth`:
// reflections on the paths to and from the person together. Takes seconds to a minute.
Expected<PersonCells> make_person_cells(const RoomModel& room,
                                        const PersonReference& reference,
                                        double cell,
                                        int depth);

}  // namespace rayloc
