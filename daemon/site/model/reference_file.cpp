#include "daemon/site/model/reference_file.h"

#include <algorithm>
#include <utility>

#include "daemon/site/model/toml_reader.h"

namespace rayloc {
namespace {

constexpr std::int64_t kReferenceFormat = 1;

std::string link_text(const PersonLink& link, const RoomModel& room) {
  const RoomAccessPoint& ap = room.access_points[link.access_point];
  std::string text = "\n[[transmitter.link]]\naccess_point = \"" + ap.id +
                     "\"\nroom_fit = " + to_text(link.room_fit) + "\nscale = [" +
                     pair_text(link.scale) + "]\n";
  const std::size_t tones = room.grid.size();
  for (std::size_t rx_chain = 0; rx_chain < ap.rx_chains.size(); ++rx_chain) {
    text += "[[transmitter.link.chain]]\ncore = " + std::to_string(ap.rx_chains[rx_chain]) +
            "\nempty = [";
    for (std::size_t k = 0; k < tones; ++k) {
      text += (k % 4 == 0 ? "\n  " : " ") + pair_text(link.empty[rx_chain * tones + k]) + ",";
    }
    text += "\n]\n";
  }
  return text;
}

std::string person_text(const PersonModel& person, std::size_t points) {
  const TargetBody& body = person.body;
  return "\n[person]\nspots = " + std::to_string(points) +
         "  # known places that it was fitted to; 0: as site.toml states\nradius_m = " +
         to_text(body.semi_axes[0]) + "\nheight_m = " + to_text(body.height) +
         "\nrelative_permittivity = " + to_text(body.relative_permittivity) +
         "\nconductivity = " + to_text(body.conductivity) +
         "\nstrength_variance = " + to_text(person.strength_variance) +
         "\nway_variance = " + to_text(person.path_variance) +
         "\nfront_sigma_m = " + to_text(person.front_offset_sigma) +
         "\ndiffuse = " + to_text(person.diffuse) + "\nnoise = " + to_text(person.noise) +
         "\ntemper = " + to_text(person.likelihood_exponent) + "\n" +
         (person.second_person
              ? "second_person = " + to_text(*person.second_person) +
                    "  # difference of log-likelihoods from which on one is accepted\n"
              : "");
}

PersonModel read_person(const TomlTable& root) {
  PersonModel person;
  const auto table = root.table("person");
  if (!table) {
    root.error("[person] is missing; record the empty room again (rayloc reference)");
    return person;
  }
  table->ask_for("spots");
  TargetBody& body = person.body;
  const double radius = table->number("radius_m", {0.05, 0.5, "m"}).value_or(body.semi_axes[0]);
  body.semi_axes = {radius, radius};
  body.height = table->number("height_m", {0.3, 2.5, "m"}).value_or(body.height);
  body.relative_permittivity =
      table->number("relative_permittivity", {1.0, 1e4}).value_or(body.relative_permittivity);
  body.conductivity = table->number("conductivity", {0.0, 1e9, "S/m"}).value_or(body.conductivity);
  person.strength_variance =
      table->number("strength_variance", {0.0, 100.0}).value_or(person.strength_variance);
  person.path_variance = table->number("way_variance", {0.0, 100.0}).value_or(person.path_variance);
  person.front_offset_sigma =
      table->number("front_sigma_m", {0.0, 1.0, "m"}).value_or(person.front_offset_sigma);
  person.diffuse = table->number("diffuse", {0.0, 100.0}).value_or(person.diffuse);
  person.noise = table->number("noise", {1e-9, 1.0}).value_or(person.noise);
  person.likelihood_exponent =
      table->number("temper", {1e-3, 1.0}).value_or(person.likelihood_exponent);
  person.second_person = table->number("second_person", {0.0, 1e9});
  return person;
}

std::vector<std::complex<double>> read_empty(const TomlTable& table,
                                             const RoomAccessPoint& ap,
                                             std::size_t tones) {
  std::vector<std::complex<double>> empty(ap.rx_chains.size() * tones);
  const auto chains = table.tables("chain");
  if (chains.size() != ap.rx_chains.size()) {
    table.error("has " + std::to_string(chains.size()) + " chains, site.toml states " +
                std::to_string(ap.rx_chains.size()) + " for access point '" + ap.id +
                "'; record the empty room again (rayloc reference)");
    return empty;
  }
  for (std::size_t i = 0; i < chains.size(); ++i) {
    chains[i].require({{"core", "core = 0"}, {"empty", "empty = [[1.0, 0.0], ...]"}});
    if (const auto rx_chain = chains[i].integer("core", {0.0, 255.0, ""});
        rx_chain != ap.rx_chains[i]) {
      chains[i].error_at("core", "'core' is not that of site.toml; record the empty room again");
    }
    const auto values =
        chains[i].pairs("empty", "empty = [[1.0, 0.0]]").value_or(std::vector<TomlTable::Pair>());
    if (values.size() != tones) {
      chains[i].error_at("empty",
                         "'empty' has " + std::to_string(values.size()) + " pairs for " +
                             std::to_string(tones) + " tones; record the empty room again");
      continue;
    }
    for (std::size_t k = 0; k < tones; ++k) {
      empty[i * tones + k] = {values[k].values[0], values[k].values[1]};
    }
  }
  return empty;
}

std::optional<PersonLink> read_link(const TomlTable& table, const RoomModel& room) {
  table.require({{"access_point", "access_point = \"ap1\""}, {"scale", "scale = [[1.0, 0.0]]"}});
  const std::string id = table.string("access_point").value_or("");
  const auto ap = std::find_if(room.access_points.begin(),
                               room.access_points.end(),
                               [&](const RoomAccessPoint& one) { return one.id == id; });
  if (ap == room.access_points.end()) {
    table.error_at("access_point", "the site has no access point '" + id + "'");
    return std::nullopt;
  }
  PersonLink link;
  link.access_point = static_cast<std::size_t>(ap - room.access_points.begin());
  link.room_fit = table.number("room_fit", {0.0, 1.0}).value_or(0.0);
  const auto scale = table.pairs("scale", "scale = [[1.0, 0.0]]");
  if (scale && scale->size() == 1) {
    link.scale = {scale->front().values[0], scale->front().values[1]};
  } else if (scale) {
    table.error_at("scale", "'scale' is one pair: real and imaginary part");
  }
  link.empty = read_empty(table, *ap, room.grid.size());
  return link;
}

std::optional<PersonReference> read_transmitter(const TomlTable& table,
                                                const Site& site,
                                                const RoomModel& room) {
  table.require({{"mac", "mac = \"02:52:4c:00:00:02\""}, {"position", "position = [0, 0, 1]"}});
  const auto mac = parse_mac_address(table.string("mac").value_or(""));
  const SiteTransmitter* stated = mac ? find_fixed_transmitter(site, *mac) : nullptr;
  if (stated == nullptr) {
    table.error_at("mac", "is no fixed transmitter of site.toml; record the empty room again");
    return std::nullopt;
  }
  PersonReference reference;
  reference.mac = *mac;
  const auto place = table.numbers<3>("position", "position = [0, 0, 1]");
  const std::array<double, 3> p = place.value_or(std::array<double, 3>{});
  reference.transmitter =
      Transmitter{{{p[0], p[1], p[2]}, {}, stated->pattern, stated->polarization}};
  for (const TomlTable& child : table.tables("link")) {
    if (auto link = read_link(child, room)) {
      reference.links.push_back(*std::move(link));
    }
  }
  reference.area = stated_area(site);
  return reference;
}

Expected<std::vector<PersonReference>> read_references(TomlDocument& document,
                                                       const Site& site,
                                                       const RoomModel& room) {
  const TomlTable root = document.root();
  root.require({{"format", "format = 1"}, {"id", "id = \"...\""}, {"calibration", "\"...\""}});
  if (const auto format = root.integer("format", {}); format && *format != kReferenceFormat) {
    root.error_at("format",
                  "format " + std::to_string(*format) + " is not known; this program reads " +
                      std::to_string(kReferenceFormat) +
                      ": record the empty room again (rayloc reference)");
  }
  const std::string id = root.string("id").value_or("");
  const std::string calibration = root.string("calibration").value_or("");
  if (calibration != room.calibration_id) {
    root.error_at("calibration",
                  "made with calibration " + calibration + ", the site has " + room.calibration_id +
                      "; record the empty room again (rayloc reference)");
  }
  const PersonModel person = read_person(root);
  std::vector<PersonReference> references;
  for (const TomlTable& table : root.tables("transmitter")) {
    if (auto reference = read_transmitter(table, site, room)) {
      reference->person = person;
      reference->id = id;
      references.push_back(*std::move(reference));
    }
  }
  RAYLOC_TRY(document.finish());
  return references;
}

}  // namespace

PersonModel stated_person(const Site& site) {
  PersonModel person;
  const SitePerson stated = site.person.value_or(SitePerson{});
  person.body.semi_axes = {stated.radius, stated.radius};
  person.body.height = stated.height;
  return person;
}

std::optional<PersonArea> stated_area(const Site& site) {
  if (!site.person || !site.person->area_centre || !site.person->area_radius) {
    return std::nullopt;
  }
  const auto& centre = *site.person->area_centre;
  return PersonArea{centre[0], centre[1], *site.person->area_radius};
}

std::string reference_of_calibration(std::string text, const std::string& calibration_id) {
  const std::string key = "\ncalibration = \"";
  if (const std::size_t at = text.find(key); at != std::string::npos) {
    const std::size_t begin = at + key.size();
    text.replace(begin, text.find('"', begin) - begin, calibration_id);
  }
  return text;
}

std::string reference_toml(const std::vector<PersonReference>& references,
                           const RoomModel& room,
                           std::size_t points) {
  std::string text =
      "# Written by `rayloc reference`; it belongs to the calibration beside it. Do not edit:\n"
      "# record the empty room again instead.\n"
      "format = " +
      std::to_string(kReferenceFormat) + "\nid = \"" + references.front().id +
      "\"  # of all inputs\ncalibration = \"" + room.calibration_id + "\"\n";
  text += person_text(references.front().person, points);
  for (const PersonReference& reference : references) {
    const Vec3d& p = reference.transmitter.position;
    text += "\n[[transmitter]]\nmac = \"" + to_string(reference.mac) + "\"\nposition = [" +
            to_text(p.x) + ", " + to_text(p.y) + ", " + to_text(p.z) + "]  # m\n";
    for (const PersonLink& link : reference.links) {
      text += link_text(link, room);
    }
  }
  return text;
}

Expected<std::vector<PersonReference>> load_references(const Site& site, const RoomModel& room) {
  if (!site.reference_file) {
    return std::vector<PersonReference>();
  }
  auto document = TomlDocument::read(*site.reference_file);
  RAYLOC_TRY(document);
  return read_references(**document, site, room);
}

}  // namespace rayloc
