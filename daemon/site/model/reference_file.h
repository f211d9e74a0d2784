// The reference file: the results of `rayloc reference` for the links of a site's fixed
// transmitters: the empty room as received by each access point, and the effect of a person on it.
//
// It is valid for the calibration it was made with.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "daemon/site/model/site.h"
#include "engine/base/expected.h"
#include "engine/person/person_reference.h"
#include "engine/room/room_model.h"

namespace rayloc {

// TOML. `references`: for each fixed transmitter; they share one person. `points`: the number of
// people at known places to which the person was fitted; 0: as stated in site.toml.
std::string reference_toml(const std::vector<PersonReference>& references,
                           const RoomModel& room,
                           std::size_t points);

// Converts the text of a reference file to another calibration: one with the same room and new
// chain gains, which the arrays of the empty room do not contain.
std::string reference_of_calibration(std::string text, const std::string& calibration_id);

// The references of the file that the site names; empty without one. An Error (kConfiguration) for
// a damaged file, or one of another calibration, access point or transmitter.
Expected<std::vector<PersonReference>> load_references(const Site& site, const RoomModel& room);

// As stated in site.toml: the expected person and the area.
PersonModel stated_person(const Site& site);
std::optional<PersonArea> stated_area(const Site& site);

}  // namespace rayloc
