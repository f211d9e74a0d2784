// Site: the operator's description of a place: the room, the carrier, the access points, the listed
// transmitters. Read from `site.toml` in a directory (INTERFACE 4).
//
// load_site() validates everything; each error names file:line:column, the mistake and the valid
// input. Unknown keys are errors with a suggestion. Lengths are metres, angles radians.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "daemon/site/model/number_range.h"
#include "engine/base/expected.h"
#include "engine/base/timestamp.h"
#include "engine/base/vec3.h"
#include "engine/channel/mac_address.h"
#include "engine/channel/ofdm_grid.h"
#include "engine/em/antenna_pattern.h"
#include "engine/scene/antenna_array.h"

namespace rayloc {

struct Carrier {
  int channel = 0;  // 802.11 channel number, 0 if not stated
  int bandwidth_mhz = 0;
  OfdmGrid grid;  // the active tones
};

struct SiteAccessPoint {
  std::string id;
  std::string format;                   // wire format; empty: detected
  AntennaArray array;                   // as surveyed
  std::vector<std::uint8_t> rx_chains;  // receive chain of each element of `array`
};

enum class TransmitterRole { kDevice, kFixed };

// [m], valid values of the standard deviation of a height.
inline constexpr NumberRange kHeightSigmaRange = {0.0, 3.0, "m"};

struct SiteTransmitter {
  TransmitterRole role = TransmitterRole::kDevice;
  MacAddress mac;
  std::string name;               // for people, may be empty
  std::optional<Vec3d> position;  // for a fixed transmitter
  double height = 1.2;            // [m], for a device
  // [m], standard deviation of a device's height; 0: the height is exact.
  double height_sigma = 0.3;
  AntennaPattern pattern = AntennaPattern::kHalfWaveDipole;
  Polarization polarization = Polarization::kVertical;
  // For a device: its power never changes, so that the received power indicates its distance.
  bool constant_power = false;
};

struct SitePerson {
  double radius = 0.165;  // [m]
  double height = 1.7;    // [m]
  std::optional<std::array<double, 2>> area_centre;
  std::optional<double> area_radius;
};

// Values that replace those of the scene file or of the ITU table, by name of the material.
struct MaterialOverride {
  std::optional<double> relative_permittivity;
  std::optional<double> conductivity;  // [S/m]
  std::optional<double> thickness;     // [m]
  std::optional<double> scattering_coefficient;
  std::optional<double> xpd_coefficient;
};

struct Georeference {
  double latitude = 0.0;   // [degrees], WGS 84, of the room's origin
  double longitude = 0.0;  // [degrees]
  double altitude = 0.0;   // [m]
  double rotation = 0.0;   // [rad], of the room's +x from east, anticlockwise
};

// A target enters when its probability of being inside was at least `enter_probability` for
// `enter_after`, leaves when it was at most `leave_probability` for `leave_after`, and dwells when
// it has been inside for `dwell_after`. All in event time.
struct SiteZone {
  std::string name;
  std::vector<std::array<double, 2>> polygon;  // [m], simple, 3 corners or more
  double enter_probability = 0.7;
  double leave_probability = 0.3;  // below enter_probability
  Duration enter_after = std::chrono::milliseconds(500);
  Duration leave_after = std::chrono::seconds(1);
  Duration dwell_after = std::chrono::seconds(10);
  std::string place;  // "site.toml:50:1: ", the prefix of messages
};

struct TargetDefaults {
  bool track_unlisted = true;
  double height = 1.2;        // [m]
  double height_sigma = 0.3;  // [m], standard deviation; 0: the height is exact
};

struct Site {
  std::string name;
  std::filesystem::path directory;
  std::filesystem::path scene_file;
  std::vector<std::filesystem::path> files;  // site.toml, and every file that it names
  Vec3d bounds_min;  // [m]; from [bounds], otherwise from the scene when it is loaded
  Vec3d bounds_max;
  bool has_bounds = false;
  Carrier carrier;
  std::vector<SiteAccessPoint> access_points;
  std::vector<SiteTransmitter> transmitters;
  std::optional<SitePerson> person;
  std::map<std::string, MaterialOverride> materials;
  std::optional<Georeference> georeference;
  std::vector<SiteZone> zones;
  TargetDefaults targets;
  std::optional<std::filesystem::path> calibration_file;  // [calibration] file
  std::optional<std::filesystem::path> reference_file;    // [reference] file
  // By method: [[training]] method, file.
  std::map<std::string, std::filesystem::path> training_files;
};

// `directory` holds site.toml; a path to a .toml file itself is accepted as well. The scene and the
// other files that the site names must exist; they are read by load_room_model().
Expected<Site> load_site(const std::filesystem::path& directory);

// The same for a text; `file` is for messages and for relative paths.
Expected<Site> parse_site(std::string_view text, const std::filesystem::path& file);

// Values that are allowed and probably mistakes, by file:line:column: zones that extend out of the
// room, whose bounding box is given.
std::vector<std::string> zone_warnings(const Site& site, const Vec3d& lower, const Vec3d& upper);

// True if `text` is valid as the id of an access point: letters, digits, '-' and '_'.
bool is_access_point_id(std::string_view text);

// Ids of all access points, in their order.
std::vector<std::string> access_point_ids(const Site& site);

// Position in `access_points` of `id`; otherwise an error that lists the valid ids.
Expected<std::size_t> find_access_point(const Site& site, const std::string& id);

// The stated transmitter with that address, or nullptr.
const SiteTransmitter* find_transmitter(const Site& site, const MacAddress& mac);
// The same if its role is kFixed, otherwise nullptr.
const SiteTransmitter* find_fixed_transmitter(const Site& site, const MacAddress& mac);

}  // namespace rayloc
