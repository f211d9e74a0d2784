#include "daemon/site/model/training_file.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "daemon/site/model/site_copy.h"
#include "daemon/site/model/toml_reader.h"
#include "daemon/site/model/weights_file.h"
#include "engine/baselines/settings.h"

namespace rayloc {
namespace {

constexpr std::int64_t kTrainingFormat = 1;

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) {
    text += (text.empty() ? "" : ", ") + word;
  }
  return text;
}

// "40 MHz at 5190000000 Hz".
std::string carrier_text(double bandwidth_mhz, double centre_hz) {
  return to_text(bandwidth_mhz) + " MHz at " + to_text(centre_hz) + " Hz";
}

std::string access_point_text(const AccessPointTraining& ap) {
  std::string text = "\n[[access_point]]\nid = \"" + ap.id +
                     "\"\npoints = " + std::to_string(ap.points) +
                     "  # surveyed, that it rests on\n";
  if (ap.sigma_psi > 0.0) {
    text += "sigma_psi = " + to_text(ap.sigma_psi) +
            "  # [rad] of the phase from antenna to antenna\noutliers = " + to_text(ap.outliers) +
            "  # share of the bursts\n";
  }
  if (ap.path_loss) {
    text += "[access_point.level]  # at_1m_dbm - 10 exponent log10(distance / m)\nat_1m_dbm = " +
            to_text(ap.path_loss->at_1m_dbm) + "\nexponent = " + to_text(ap.path_loss->exponent) +
            "\nsigma_db = " + to_text(ap.path_loss->sigma_db) + "\n";
  }
  return text;
}

// "[1, 2.5]".
template <typename Values, typename Get>
std::string list_text(const Values& values, const Get& get) {
  std::string text = "[";
  for (std::size_t i = 0; i < values.size(); ++i) {
    text += (i == 0 ? "" : ", ") + to_text(get(values[i]));
  }
  return text + "]";
}

std::string network_text(const PlaceNetwork& network, const std::string& method) {
  const auto itself = [](double value) { return value; };
  std::string text =
      "\n[network]  # classifies places; [m]\nweights = \"" + method + ".f32\"\nhash = \"" +
      weights_hash(weights_bytes(network.parameters)) +
      "\"  # of that file\nknows_nobody = " + (network.has_empty_room ? "true" : "false") +
      "\ntemperature = " + to_text(network.temperature) + "\nsigma = " + to_text(network.sigma) +
      "\nresidual = " + to_text(network.residual) + "\nmean = " + list_text(network.mean, itself) +
      "\ndeviation = " + list_text(network.deviation, itself) +
      "\nloss = " + list_text(network.loss, itself) + "  # of each epoch\n";
  const auto& places = network.places;
  text += "x = " + list_text(places, [](const Vec3d& place) { return place.x; }) + "\n";
  text += "y = " + list_text(places, [](const Vec3d& place) { return place.y; }) + "\n";
  return text + "z = " + list_text(places, [](const Vec3d& place) { return place.z; }) + "\n";
}

AccessPointTraining read_access_point_training(const TomlTable& table, bool is_of_network) {
  table.require({{"id", "id = \"ap1\""}});
  if (!is_of_network) {
    table.require({{"sigma_psi", "sigma_psi = 0.4"}, {"outliers", "outliers = 0.1"}});
  }
  AccessPointTraining ap;
  ap.id = table.string("id").value_or("");
  ap.points = static_cast<std::size_t>(table.integer("points", {0.0, 1e9, ""}).value_or(0));
  ap.sigma_psi = table.number("sigma_psi", {1e-3, 10.0, "rad"}).value_or(1.0);
  ap.outliers = table.number("outliers", {0.0, 1.0, ""}).value_or(0.0);
  if (const auto path_loss = table.table("level")) {
    PathLossLaw& law = ap.path_loss.emplace();
    law.at_1m_dbm = path_loss->number("at_1m_dbm", {-300.0, 300.0, "dBm"}).value_or(0.0);
    law.exponent = path_loss->number("exponent", {-20.0, 20.0, ""}).value_or(kUsualExponent);
    law.sigma_db = path_loss->number("sigma_db", {1e-3, 100.0, "dB"}).value_or(kUsualPowerSigma);
  }
  return ap;
}

std::vector<float> read_weights(const TomlTable& table) {
  const auto file = table.path("weights");
  const auto hash = table.string("hash");
  if (!file || !hash) {
    return {};
  }
  const auto bytes = read_file(*file);
  if (!bytes) {
    table.error_at("weights", bytes.error().message + ": train again (rayloc train)");
    return {};
  }
  auto weights = parse_weights(*bytes, *file);
  if (!weights) {
    table.error_at("weights", weights.error().message);
    return {};
  }
  if (weights_hash(*bytes) != *hash) {
    table.error_at("hash",
                   file->string() +
                       " holds other weights than were trained: train again "
                       "(rayloc train)");
  }
  return *std::move(weights);
}

PlaceNetwork read_network(const TomlTable& table) {
  table.require({{"weights", "weights = \"cifi.f32\""},
                 {"hash", "hash = \"...\""},
                 {"x", "x = [0.1, 0.2]"},
                 {"y", "y = [0.1, 0.2]"},
                 {"z", "z = [1.2, 1.2]"}});
  constexpr NumberRange kPlace = {-1e6, 1e6, "m"};
  constexpr NumberRange kAny = {-1e9, 1e9, ""};
  PlaceNetwork network;
  network.parameters = read_weights(table);
  network.has_empty_room = table.boolean("knows_nobody").value_or(false);
  network.temperature = table.number("temperature", {1e-3, 1e3, ""}).value_or(1.0);
  network.sigma = table.number("sigma", {1e-3, 1e3, "m"}).value_or(1.0);
  network.residual = table.number("residual", {0.0, 1.0, ""}).value_or(0.0);
  network.mean = table.numbers("mean", kAny);
  network.deviation = table.numbers("deviation", {1e-9, 1e9, ""});
  network.loss = table.numbers("loss", kAny);
  const auto x = table.numbers("x", kPlace);
  const auto y = table.numbers("y", kPlace);
  const auto z = table.numbers("z", kPlace);
  if (x.size() != y.size() || x.size() != z.size()) {
    table.error_at("x", "x, y and z are as many: one of each place");
    return network;
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    network.places.push_back({x[i], y[i], z[i]});
  }
  return network;
}

void read_settings(const TomlTable& root,
                   std::span<const BaselineSetting> settings,
                   Training& training) {
  for (const std::string& text : root.strings("settings")) {
    if (auto read = read_baseline_value(text, training.method, settings, training.values); !read) {
      root.error_at("settings", read.error().message);
    }
  }
}

// Compares the carrier of the training with the site's.
void check_radio(const TomlTable& root, const Site& site, const Training& training) {
  const double bandwidth = root.number("bandwidth_mhz", {0.0, 1e4, "MHz"}).value_or(0.0);
  const double centre = root.number("centre_hz", {0.0, 1e12, "Hz"}).value_or(0.0);
  std::vector<std::string> learned;
  for (const AccessPointTraining& ap : training.access_points) {
    learned.push_back(ap.id);
  }
  const auto stated = access_point_ids(site);
  const bool all_stated = std::all_of(learned.begin(), learned.end(), [&](const std::string& id) {
    return std::find(stated.begin(), stated.end(), id) != stated.end();
  });
  const auto here = static_cast<double>(site.carrier.bandwidth_mhz);
  if (bandwidth != here || centre != site.carrier.grid.centre_hz || !all_stated) {
    root.error_at("bandwidth_mhz",
                  "trained at " + carrier_text(bandwidth, centre) + " with " + joined(learned) +
                      "; the site has " + carrier_text(here, site.carrier.grid.centre_hz) +
                      " with " + joined(stated) + ": train again (rayloc train)");
  }
}

Expected<std::shared_ptr<const Training>> read_training_table(
    TomlDocument& document,
    const Site& site,
    const std::string& method,
    const RoomModel& room,
    std::span<const BaselineSetting> settings) {
  const TomlTable root = document.root();
  root.require({{"format", "format = 1"}, {"method", "method = \"...\""}, {"calibration", "..."}});
  if (const auto format = root.integer("format", {}); format && *format != kTrainingFormat) {
    root.error_at("format",
                  "format " + std::to_string(*format) + " is not known; this program reads " +
                      std::to_string(kTrainingFormat) + ": train again (rayloc train)");
  }
  root.ask_for("content");
  auto training = std::make_shared<Training>();
  training->method = root.string("method").value_or("");
  if (training->method != method) {
    root.error_at("method", "is of method " + training->method + ", not of " + method);
  }
  training->calibration_id = root.string("calibration").value_or("");
  if (training->calibration_id != room.calibration_id) {
    root.error_at("calibration",
                  "trained with calibration " + training->calibration_id + ", the site has " +
                      room.calibration_id + ": train again (rayloc train)");
  }
  read_settings(root, settings, *training);
  if (const auto network = root.table("network")) {
    training->network = read_network(*network);
  }
  for (const TomlTable& table : root.tables("access_point")) {
    training->access_points.push_back(
        read_access_point_training(table, training->network.has_value()));
  }
  if (const auto sender = root.string("transmitter")) {
    if (const auto mac = parse_mac_address(*sender)) {
      training->transmitter = *mac;
    } else {
      root.error_at("transmitter", "'" + *sender + "' is no address");
    }
  }
  check_radio(root, site, *training);
  for (const std::string& text : root.strings("constant_power")) {
    const auto mac = parse_mac_address(text);
    if (!mac) {
      root.error_at("constant_power", "'" + text + "' is no address");
      continue;
    }
    if (const SiteTransmitter* stated = find_transmitter(site, *mac);
        stated != nullptr && stated->constant_power) {
      training->constant_power.push_back(*mac);
    }
  }
  RAYLOC_TRY(document.finish());
  return training;
}

}  // namespace

std::string training_toml(const Training& training, const Site& site, const std::string& content) {
  std::string text =
      "# Written by `rayloc train`; it belongs to the calibration of the site. Do not edit: train\n"
      "# again instead.\nformat = " +
      std::to_string(kTrainingFormat) + "\nmethod = \"" + training.method + "\"\ncontent = \"" +
      content + "\"  # of the recordings and the points\ncalibration = \"" +
      training.calibration_id +
      "\"\nbandwidth_mhz = " + std::to_string(site.carrier.bandwidth_mhz) +
      "\ncentre_hz = " + to_text(site.carrier.grid.centre_hz) + "\n";
  if (!training.constant_power.empty()) {
    text += "constant_power = [";
    for (std::size_t i = 0; i < training.constant_power.size(); ++i) {
      text += (i == 0 ? "\"" : ", \"") + to_string(training.constant_power[i]) + "\"";
    }
    text += "]  # transmitters that the laws of level hold for\n";
  }
  if (training.transmitter) {
    text += "transmitter = \"" + to_string(*training.transmitter) + "\"  # that sent\n";
  }
  if (!training.values.empty()) {
    text += "settings = [";
    for (const auto& [key, value] : training.values) {
      const auto* number = std::get_if<double>(&value);
      text += (text.back() == '[' ? "\"" : ", \"") + key + "=" +
              (number == nullptr ? std::get<std::string>(value) : to_text(*number)) + "\"";
    }
    text += "]\n";
  }
  for (const AccessPointTraining& ap : training.access_points) {
    text += access_point_text(ap);
  }
  if (training.network) {
    text += network_text(*training.network, training.method);
  }
  return text;
}

Expected<std::shared_ptr<const Training>> load_training(const Site& site,
                                                        const std::string& method,
                                                        const RoomModel& room,
                                                        std::span<const BaselineSetting> settings) {
  const auto file = site.training_files.find(method);
  if (file == site.training_files.end()) {
    return nullptr;
  }
  const auto document = TomlDocument::read(file->second);
  RAYLOC_TRY(document);
  return read_training_table(**document, site, method, room, settings);
}

}  // namespace rayloc
