// The tables of site.toml, each read into its part of a Site. Only site.cpp uses this.
//
// Errors are recorded in the table's document (toml_reader.h).
#pragma once

#include "daemon/site/model/keys/site_keys.h"
#include "daemon/site/model/keys/site_limits.h"
#include "daemon/site/model/site.h"
#include "daemon/site/model/toml_reader.h"

namespace rayloc {

// site_radio.cpp
void read_carrier(const SiteTable& carrier, Carrier& out);
// `tables`: [[access_point]].
void read_access_points(std::span<const SiteTable> tables, Site& site);
void read_transmitters(const SiteTable& root, Site& site);

// site_antenna.cpp. For an access point or transmitter: "pattern", or "pattern_file" with a table
// of gains, which is read here; a half-wave dipole if neither is stated.
AntennaPattern read_pattern(const SiteTable& table);
Polarization read_polarization(const SiteTable& table);

// site_place.cpp
void read_bounds(const SiteTable& bounds, Site& site);
void read_person(const SiteTable& person, Site& site);
void read_materials(const SiteTable& root, Site& site);
void read_georeference(const SiteTable& georeference, Site& site);
void read_targets(const SiteTable& targets, Site& site);

// site_zone.cpp
void read_zones(const SiteTable& root, Site& site);

// "position" of an access point or transmitter: three numbers inside the bounds, if any are stated.
std::optional<Vec3d> read_position(const SiteTable& table, const Site& site);

// A name that is used in a topic ("v1/location/NAME/..."): one line without '/'.
std::optional<std::string> read_topic_name(const TomlTable& table);

}  // namespace rayloc
