// fit_person_geometry: place of the fixed transmitter, to millimetres, and width of a person, from
// people at known places.
//
// The empty room does not determine the transmitter's place well: one array receives it over few
// strong paths. People at tens of places act as tens of mirrors around it. The squared residuals of
// a point, whitened, with the empty room and a delay projected out, are compared over all complex
// factors of a link and all places near the known one, at little cost once the rays are known.
#pragma once

#include <span>

#include "engine/base/expected.h"
#include "engine/base/vec3.h"
#include "engine/person/calibrate/person_fit.h"

namespace rayloc {

struct PersonGeometry {
  Vec3d shift;          // [m], of the transmitter, from the reference's
  double radius = 0.0;  // [m], of the body
};

Expected<PersonGeometry> fit_person_geometry(const RoomModel& room,
                                             const PersonReference& reference,
                                             std::span<const PersonPoint> points,
                                             const PersonFitOptions& options);

}  // namespace rayloc
