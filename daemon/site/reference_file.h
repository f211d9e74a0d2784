// The reference file: what `rayloc reference` found out about the links of a site's fixed
// transmitters: the empty room as each access point hears it, and what a person does to them.
//
// It is valid for the calibration it was made with.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "daemon/site/site.h"
#include "engine/base/expected.h"
#include "engine/person/person_reference.h"
#include "engine/room/room_model.h"

namespace rayloc {

// TOML. `references`: of each fixed transmitter; they share one person. `spots`: how many people at
// known places the person was fitted to; 0: as site.toml states.
std::string reference_toml(const std::vector<PersonReference>& references,
                           const RoomModel& room,
                           std::size_t spots);

// `text` of a reference file as that of another calibration: one with the same room and new chain
// gains, which the arrays of the empty room do not hold.
std::string reference_of_calibration(std::string text, const std::string& calibration_id);

// The references of the file that the site names; none without one. An Error (kConfiguration) for
// a file that is broken, or of another calibration, access point or transmitter.
Expected<std::vector<PersonReference>> load_references(const Site& site, const RoomModel& room);

// As site.toml has it: the person that is expected, and where.
PersonModel stated_person(const Site& site);
std::optional<PersonArea> stated_area(const Site& site);

}  // namespace rayloc
