// The keys of a second day, and the reader of their file.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "daemon/lab/simulate/second_day.h"
#include "daemon/site/model/toml_reader.h"

namespace rayloc {
namespace {

using D = SecondDay;

constexpr NumberRange kTurnDegrees = {0.0, 180.0, "degrees"};
constexpr NumberRange kMetres = {0.0, 20.0, "m"};

constexpr std::array kSecondDayKeys = std::to_array<SecondDayKey>({
    {"day",
     &D::day,
     {2, 1'000'000, {}},
     true,
     2,
     2,
     "number of the day; each has its own random draws"},
    {"chain_phase_deg",
     &D::chain_phase_deg,
     kTurnDegrees,
     false,
     180,
     0,
     "maximum phase change of a chain by a power cycle"},
    {"chain_gain_db",
     &D::chain_gain_db,
     {0.0, 20.0, "dB"},
     false,
     1.5,
     0,
     "standard deviation of the gain change of a chain by a power cycle"},
    {"moved_things",
     &D::moved_things,
     {0, 100, {}},
     true,
     3,
     0,
     "number of chairs, boxes and other low, small objects that are moved"},
    {"moved_least_m",
     &D::moved_least_m,
     kMetres,
     false,
     0.2,
     0.2,
     "minimum distance of their move along the floor"},
    {"moved_most_m",
     &D::moved_most_m,
     kMetres,
     false,
     0.6,
     0.6,
     "maximum distance of their move along the floor"},
    {"access_point_moved_m",
     &D::access_point_moved_m,
     {0.0, 1.0, "m"},
     false,
     0.002,
     0,
     "displacement of each access point, in a random direction"},
    {"access_point_turned_deg",
     &D::access_point_turned_deg,
     kTurnDegrees,
     false,
     0.3,
     0,
     "rotation of each access point, about a random axis"},
});

SecondDay day_from(double SecondDayKey::*column) {
  SecondDay day;
  for (const SecondDayKey& key : kSecondDayKeys) {
    day.*key.member = key.*column;
  }
  return day;
}

Expected<SecondDay> read_second_day_keys(TomlDocument& document) {
  static constexpr std::array<std::string_view, 2> kBases = {"default", "none"};
  const TomlTable root = document.root();
  SecondDay day = root.choice("base", kBases).value_or("default") == "none" ? unchanged_day()
                                                                            : default_second_day();
  for (const SecondDayKey& key : kSecondDayKeys) {
    double& number = day.*key.member;
    number = root.number(key.key, key.range).value_or(number);
    if (key.is_whole && number != std::trunc(number)) {
      root.error_at(key.key, "'" + std::string(key.key) + "' must be a whole number");
    }
  }
  if (day.moved_most_m < day.moved_least_m) {
    root.error_at("moved_most_m",
                  "'moved_most_m' is " + to_text(day.moved_most_m) + ", less than " +
                      to_text(day.moved_least_m) + ", the 'moved_least_m'; exchange them");
  }
  RAYLOC_TRY(document.finish());
  return day;
}

}  // namespace

std::span<const SecondDayKey> second_day_keys() { return kSecondDayKeys; }

SecondDay default_second_day() { return day_from(&SecondDayKey::preset); }
SecondDay unchanged_day() { return day_from(&SecondDayKey::none); }

Expected<SecondDay> load_second_day(const std::filesystem::path& file) {
  auto document = TomlDocument::read(file);
  return document ? read_second_day_keys(**document)
                  : tl::make_unexpected(std::move(document.error()));
}

Expected<SecondDay> parse_second_day(std::string_view text, const std::filesystem::path& file) {
  auto document = TomlDocument::parse(text, file);
  return document ? read_second_day_keys(**document)
                  : tl::make_unexpected(std::move(document.error()));
}

std::string second_day_help() {
  constexpr std::size_t kWidth = 32;  // width of "access_point_moved_m = 0.002"
  const SecondDay usual = default_second_day();
  std::string text;
  for (const SecondDayKey& key : kSecondDayKeys) {
    std::string line = std::string(key.key) + " = " + to_text(usual.*key.member);
    line.resize(std::max(line.size(), kWidth), ' ');
    text += line + "# " + std::string(key.meaning) + "\n";
  }
  return text;
}

}  // namespace rayloc
