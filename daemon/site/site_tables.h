// The tables of site.toml, each read into its part of a Site. Only site.cpp uses this.
//
// Errors are noted in the table's document (toml_reader.h).
#pragma once

#include "daemon/site/site.h"
#include "daemon/site/toml_reader.h"

namespace rayloc {

// site_radio.cpp
void read_carrier(const TomlTable& carrier, Carrier& out);
void read_access_points(const TomlTable& root, Site& site);
void read_transmitters(const TomlTable& root, Site& site);

// site_antenna.cpp. Of an access point or transmitter: "pattern", or "pattern_file" with a table of
// gains, which is read here; a half-wave dipole when neither is there.
AntennaPattern read_pattern(const TomlTable& table);
Polarization read_polarization(const TomlTable& table);

// site_place.cpp
void read_bounds(const TomlTable& bounds, Site& site);
void read_person(const TomlTable& person, Site& site);
void read_materials(const TomlTable& root, Site& site);
void read_georeference(const TomlTable& georeference, Site& site);
void read_targets(const TomlTable& targets, Site& site);

// site_zone.cpp
void read_zones(const TomlTable& root, Site& site);

// "position" of an access point or transmitter: three numbers inside the bounds, if there are any.
std::optional<Vec3d> read_position(const TomlTable& table, const Site& site);

// A name that becomes a part of a topic ("v1/location/NAME/..."): one line without '/'.
std::optional<std::string> read_topic_name(const TomlTable& table);

}  // namespace rayloc
