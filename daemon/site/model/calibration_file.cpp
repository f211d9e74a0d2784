#include "daemon/site/model/calibration_file.h"

#include <utility>

#include "daemon/site/model/toml_reader.h"

namespace rayloc {
namespace {

constexpr std::int64_t kCalibrationFormat = 2;

std::string value_text(const Fitted<double>& value, const char* unit) {
  return "{ value = " + to_text(value.value) + ", unit = \"" + unit +
         "\", prior = " + to_text(value.prior) + ", sigma = " + to_text(value.sigma) + " }";
}

// [[-58, -2], [2, 58]]: first and last of each run of neighbouring tones.
std::string tones_text(const std::vector<std::int16_t>& tones) {
  std::string text = "[";
  for (std::size_t i = 0; i < tones.size();) {
    std::size_t last = i;
    while (last + 1 < tones.size() && tones[last + 1] == tones[last] + 1) {
      ++last;
    }
    text += (text.size() > 1 ? ", [" : "[") + std::to_string(tones[i]) + ", " +
            std::to_string(tones[last]) + "]";
    i = last + 1;
  }
  return text + "]";
}

std::string chain_text(const CalibratedAccessPoint& ap, std::size_t rx_chain) {
  const std::size_t tones = ap.gains.grid.size();
  const std::size_t rx_chains = ap.gains.rx_chains.size();
  std::string text =
      "[[access_point.chain]]\ncore = " + std::to_string(ap.gains.rx_chains[rx_chain]) +
      "\nsigma_rad = " + to_text(ap.gain_sigma.at(rx_chain)) +
      "\nelement_y_m = " + to_text(ap.element_y.at(rx_chain));
  for (std::size_t from = 0; from < rx_chains && !ap.gains.coupling.empty(); ++from) {
    text += (from == 0 ? "\ncoupling = [" : ", ") +
            pair_text(ap.gains.coupling[rx_chain * rx_chains + from]) +
            (from + 1 == rx_chains ? "]" : "");
  }
  text += "\ngain = [";
  for (std::size_t k = 0; k < tones; ++k) {
    text += (k % 4 == 0 ? "\n  " : " ") + pair_text(ap.gains.gain[rx_chain * tones + k]) + ",";
  }
  return text + "\n]\n";
}

std::string power_text(const TransmitterPower& power) {
  return "[[access_point.level]]\ntransmitter = \"" + to_string(power.transmitter) +
         "\"\noffset_db = " + to_text(power.offset_db) + "\nsigma_db = " + to_text(power.sigma_db) +
         "\n";
}

Fitted<double> read_value(const TomlTable& table, std::string_view key, NumberRange range) {
  Fitted<double> result;
  const auto child = table.table(key);
  if (!child) {
    table.error_at(key, "'" + std::string(key) + "' is missing; calibrate again");
    return result;
  }
  child->require({{"value", "value = 0.0"}});
  result.value = child->number("value", range).value_or(0.0);
  result.prior = child->number("prior", {}).value_or(0.0);
  result.sigma = child->number("sigma", {}).value_or(0.0);
  child->ask_for("unit");
  return result;
}

void read_tones(const TomlTable& table, OfdmGrid& grid) {
  grid.centre_hz = table.number("centre_hz", {}).value_or(0.0);
  grid.spacing_hz = table.number("tone_spacing_hz", {}).value_or(0.0);
  for (const auto& run : table.pairs("tones", "tones = [[-58, -2], [2, 58]]")
                             .value_or(std::vector<TomlTable::Pair>())) {
    constexpr double kMost = 4096.0;
    if (!(run.values[0] >= -kMost && run.values[1] <= kMost && run.values[0] <= run.values[1])) {
      table.error_at("tones", "'tones': each pair is the first and the last tone of a run");
      return;
    }
    for (auto tone = static_cast<int>(run.values[0]); tone <= static_cast<int>(run.values[1]);
         ++tone) {
      if (!grid.tone_index.empty() && tone <= grid.tone_index.back()) {
        table.error_at("tones", "'tones': the runs are not ascending");
        return;
      }
      grid.tone_index.push_back(static_cast<std::int16_t>(tone));
    }
  }
}

void read_chains(const TomlTable& table, CalibratedAccessPoint& ap) {
  for (const TomlTable& chain : table.tables("chain")) {
    chain.require({{"core", "core = 0"}, {"gain", "gain = [[1.0, 0.0], ...], one pair a tone"}});
    ap.gains.rx_chains.push_back(
        static_cast<std::uint8_t>(chain.integer("core", {0.0, 255.0, ""}).value_or(0)));
    ap.gain_sigma.push_back(chain.number("sigma_rad", {}).value_or(0.0));
    ap.element_y.push_back(chain.number("element_y_m", {}).value_or(0.0));
    if (chain.has("coupling")) {  // coupling from each antenna to the core
      for (const auto& value :
           chain.pairs("coupling", "coupling = [[1.0, 0.0], [0.02, 0.01]], one pair a core")
               .value_or(std::vector<TomlTable::Pair>())) {
        ap.gains.coupling.emplace_back(value.values[0], value.values[1]);
      }
    }
    const auto gains =
        chain.pairs("gain", "gain = [[1.0, 0.0]]").value_or(std::vector<TomlTable::Pair>());
    if (gains.size() != ap.gains.grid.size()) {
      chain.error_at("gain",
                     "'gain' has " + std::to_string(gains.size()) + " pairs for " +
                         std::to_string(ap.gains.grid.size()) + " tones; calibrate again");
    }
    for (const auto& gain : gains) {
      ap.gains.gain.emplace_back(gain.values[0], gain.values[1]);
    }
  }
  const std::size_t rx_chains = ap.gains.rx_chains.size();
  if (!ap.gains.coupling.empty() && ap.gains.coupling.size() != rx_chains * rx_chains) {
    table.error_at("chain",
                   "'coupling' of every chain has as many pairs as there are chains, or none has "
                   "it; calibrate again");
    ap.gains.coupling.clear();
  }
}

void read_powers(const TomlTable& table, CalibratedAccessPoint& ap) {
  for (const TomlTable& power : table.tables("level")) {
    power.require({{"transmitter", "transmitter = \"02:52:4c:00:00:01\""},
                   {"offset_db", "offset_db = -12.5"},
                   {"sigma_db", "sigma_db = 2.0"}});
    const auto text = power.string("transmitter");
    const auto offset = power.number("offset_db", {});
    const auto sigma = power.number("sigma_db", {1e-3, 1e3, "dB"});
    if (!text || !offset || !sigma) {
      continue;  // already reported
    }
    if (const auto mac = parse_mac_address(*text)) {
      ap.powers.push_back({*mac, *offset, *sigma});
    } else {
      power.error_at("transmitter", mac.error().message);
    }
  }
}

CalibratedAccessPoint read_calibrated_access_point(const TomlTable& table) {
  table.require({{"id", "id = \"ap1\""},
                 {"centre_hz", "centre_hz = 5190000000"},
                 {"tone_spacing_hz", "tone_spacing_hz = 312500"},
                 {"tones", "tones = [[-58, -2], [2, 58]]"},
                 {"chain", "[[access_point.chain]] with core and gain"}});
  CalibratedAccessPoint ap;
  ap.id = table.string("id").value_or("");
  ap.points = static_cast<std::size_t>(table.integer("points", {0.0, 1e9, ""}).value_or(0));
  for (const NamedValue& named : calibrated_values()) {
    // Older calibrations have no decay.
    if (named.value != &CalibratedAccessPoint::diffuse_decay || table.has(named.name)) {
      ap.*named.value = read_value(table, named.name, named.range);
    }
  }
  read_tones(table, ap.gains.grid);
  read_chains(table, ap);
  read_powers(table, ap);
  return ap;
}

CalibratedSurface read_surface(const TomlTable& table) {
  table.require({{"index", "index = 3"}, {"correction", "correction = [[1.0, 0.0]]"}});
  CalibratedSurface surface;
  surface.index = static_cast<std::size_t>(table.integer("index", {0.0, 1e9, ""}).value_or(0));
  const auto value = table.pairs("correction", "correction = [[1.0, 0.0]]");
  if (value && value->size() == 1) {
    surface.correction = {value->front().values[0], value->front().values[1]};
  } else if (value) {
    table.error_at("correction", "'correction' is one pair: real and imaginary part");
  }
  return surface;
}

RoomParameter read_parameter(const TomlTable& table) {
  table.require({{"name", "name = \"wall.offset\""}, {"value", "value = 0.0"}});
  return {{table.number("value", {}).value_or(0.0),
           table.number("prior", {}).value_or(0.0),
           table.number("sigma", {}).value_or(0.0)},
          parse_parameter_id(table.string("name").value_or("")),
          table.string("unit").value_or(""),
          table.number("prior_sigma", {}).value_or(0.0)};
}

std::string surface_text(const CalibratedSurface& surface) {
  return "\n[[surface]]\nindex = " + std::to_string(surface.index) + "\ncorrection = [" +
         pair_text(surface.correction) + "]\n";
}

// A TOML string. Objects of a scene may have any name.
std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      result += '\\';
    }
    result += static_cast<unsigned char>(c) < 0x20 ? '?' : c;
  }
  return result + '"';
}

std::string parameter_text(const RoomParameter& parameter) {
  return "\n[[parameter]]\nname = " + quoted(to_string(parameter.id)) +
         "\nunit = " + quoted(parameter.unit) + "\nvalue = " + to_text(parameter.value) +
         "\nprior = " + to_text(parameter.prior) +
         "\nprior_sigma = " + to_text(parameter.prior_sigma) +
         "\nsigma = " + to_text(parameter.sigma) + "\n";
}

Expected<CalibrationFile> read_calibration_document(TomlDocument& document) {
  CalibrationFile calibration;
  const TomlTable root = document.root();
  root.require({{"format", "format = 1"}, {"id", "id = \"...\""}, {"scene", "scene = \"...\""}});
  if (const auto format = root.integer("format", {}); format && *format != kCalibrationFormat) {
    root.error_at("format",
                  "format " + std::to_string(*format) + " is not known; this program reads " +
                      std::to_string(kCalibrationFormat) + ": calibrate again");
  }
  calibration.id = root.string("id").value_or("");
  calibration.scene_hash = root.string("scene").value_or("");
  calibration.points_hash = root.string("points").value_or("");
  // Above 1 if the model states more error than it has.
  calibration.likelihood_exponent = read_value(root, "temper", {0.0, 2.0, ""});
  if (root.has("least_sigma")) {  // older calibrations have none
    calibration.sigma_floor = read_value(root, "least_sigma", {0.0, 1.0, ""});
  }
  calibration.method = root.string("method").value_or("");
  calibration.ray_depth =
      static_cast<int>(root.integer("ray_depth", {0.0, 16.0, ""}).value_or(kRayDepth));
  calibration.transmission = root.boolean("transmission").value_or(false);
  for (const TomlTable& table : root.tables("access_point")) {
    calibration.access_points.push_back(read_calibrated_access_point(table));
  }
  for (const TomlTable& table : root.tables("surface")) {
    calibration.surfaces.push_back(read_surface(table));
  }
  for (const TomlTable& table : root.tables("parameter")) {
    calibration.parameters.push_back(read_parameter(table));
  }
  RAYLOC_TRY(document.finish());
  return calibration;
}

}  // namespace

const std::vector<NamedValue>& calibrated_values() {
  using Ap = CalibratedAccessPoint;
  static const std::vector<NamedValue> kValues = {
      {"position_x", "m", &Ap::position_x},
      {"position_y", "m", &Ap::position_y},
      {"position_z", "m", &Ap::position_z},
      {"yaw_offset", "rad", &Ap::yaw_offset},
      {"pitch_offset", "rad", &Ap::pitch_offset},
      {"roll_offset", "rad", &Ap::roll_offset},
      {"plan_tolerance", "m", &Ap::plan_tolerance, {0.0, 1.0}},
      {"diffuse", "share of the traced power at 3 m", &Ap::diffuse, {0.0, 1e3}},
      {"diffuse_exponent", "1", &Ap::diffuse_exponent, {-10.0, 10.0}},
      {"diffuse_decay", "s", &Ap::diffuse_decay, {1e-10, 1e-6}},
      // With zero noise a covariance cannot be inverted.
      {"noise", "share of the power", &Ap::noise, {1e-6, 1e3}},
  };
  return kValues;
}

std::string to_toml(const CalibrationFile& calibration) {
  std::string text =
      "# Written by `rayloc calibrate`; it belongs to the scene beside it. Do not edit: calibrate\n"
      "# again instead. sigma 0: the data did not bound the value.\n"
      "format = " +
      std::to_string(kCalibrationFormat) + "\nid = \"" + calibration.id +
      "\"  # of all inputs\nscene = \"" + calibration.scene_hash +
      (calibration.points_hash.empty() ? "" : "\"\npoints = \"" + calibration.points_hash) +
      "\"\nmethod = \"" + calibration.method +
      "\"\nray_depth = " + std::to_string(calibration.ray_depth) +
      "\ntransmission = " + (calibration.transmission ? "true" : "false") +
      "\ntemper = " + value_text(calibration.likelihood_exponent, "1") +
      "\nleast_sigma = " + value_text(calibration.sigma_floor, "m") + "\n";
  for (const CalibratedAccessPoint& ap : calibration.access_points) {
    text +=
        "\n[[access_point]]\nid = \"" + ap.id + "\"\npoints = " + std::to_string(ap.points) + "\n";
    for (const NamedValue& named : calibrated_values()) {
      text += std::string(named.name) + " = " + value_text(ap.*named.value, named.unit) + "\n";
    }
    text += "centre_hz = " + to_text(ap.gains.grid.centre_hz) +
            "\ntone_spacing_hz = " + to_text(ap.gains.grid.spacing_hz) +
            "\ntones = " + tones_text(ap.gains.grid.tone_index) + "\n";
    for (std::size_t rx_chain = 0; rx_chain < ap.gains.rx_chains.size(); ++rx_chain) {
      text += chain_text(ap, rx_chain);
    }
    for (const TransmitterPower& power : ap.powers) {
      text += power_text(power);
    }
  }
  for (const CalibratedSurface& surface : calibration.surfaces) {
    text += surface_text(surface);
  }
  for (const RoomParameter& parameter : calibration.parameters) {
    text += parameter_text(parameter);
  }
  return text;
}

Expected<CalibrationFile> load_calibration_file(const std::filesystem::path& file) {
  auto document = TomlDocument::read(file);
  RAYLOC_TRY(document);
  return read_calibration_document(**document);
}

Expected<CalibrationFile> parse_calibration_file(std::string_view text,
                                                 const std::filesystem::path& file) {
  auto document = TomlDocument::parse(text, file);
  RAYLOC_TRY(document);
  return read_calibration_document(**document);
}

}  // namespace rayloc
