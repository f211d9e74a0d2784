// Formats of a Location for other programs, one line each, without its newline: pure mappings of
// the message (and the envelope's `sent`), used by `rayloc sub`.
//
//   csv      RFC 4180, columns as csv_header() names them; an absent value is an empty field
//   geojson  RFC 7946: a Feature with WGS 84 coordinates; `geometry` is null without a position
//   omlox    Location of the omlox hub API; WGS 84 with a georeference, else local metres
//
// Numbers are written with as many digits as a parser needs to restore the value.
#pragma once

#include <optional>
#include <string>

namespace rayloc::v1 {
class Envelope;
class Georeference;
}  // namespace rayloc::v1

namespace rayloc {

std::string csv_header();

// REQUIRES for all functions: envelope.has_location().
std::string to_csv(const v1::Envelope& envelope);
std::string to_geojson(const v1::Envelope& envelope, const v1::Georeference& site);
// Empty without a position, which an omlox Location requires. `site` may be null.
std::optional<std::string> to_omlox(const v1::Envelope& envelope, const v1::Georeference* site);

}  // namespace rayloc
