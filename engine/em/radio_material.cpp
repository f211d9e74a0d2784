#include "engine/em/radio_material.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "engine/base/constants.h"
#include "engine/base/six_digit_text.h"
#include "engine/base/suggestion.h"

namespace rayloc {
namespace {

// [P2040] (28), (29): eps_r = a f^b, sigma = c f^d with f in GHz, for f from `low` to `high`.
struct ItuRow {
  std::string_view name;
  double a, b, c, d;
  double low_ghz, high_ghz;
};

// [P2040] table 3. A material with two ranges has two rows. The four rows that only P.2040-4 has
// are as in NVlabs/sionna-rt, src/sionna/rt/radio_materials/itu.py, commit aeb346fe.
constexpr std::array<ItuRow, 21> kItuTable{{
    {"vacuum", 1.0, 0.0, 0.0, 0.0, 0.001, 100.0},
    {"concrete", 5.24, 0.0, 0.0462, 0.7822, 1.0, 100.0},
    {"brick", 3.91, 0.0, 0.0238, 0.16, 1.0, 40.0},
    {"plasterboard", 2.73, 0.0, 0.0085, 0.9395, 1.0, 100.0},
    {"wood", 1.99, 0.0, 0.0047, 1.0718, 0.001, 100.0},
    {"glass", 6.31, 0.0, 0.0036, 1.3394, 0.1, 100.0},
    {"glass", 5.79, 0.0, 0.0004, 1.658, 220.0, 450.0},
    {"ceiling_board", 1.48, 0.0, 0.0011, 1.0750, 1.0, 100.0},
    {"ceiling_board", 1.52, 0.0, 0.0029, 1.029, 220.0, 450.0},
    {"chipboard", 2.58, 0.0, 0.0217, 0.7800, 1.0, 100.0},
    {"plywood", 2.71, 0.0, 0.33, 0.0, 1.0, 40.0},
    {"marble", 7.074, 0.0, 0.0055, 0.9262, 1.0, 60.0},
    {"floorboard", 3.66, 0.0, 0.0044, 1.3515, 50.0, 100.0},
    {"clear_acrylic", 2.58, 0.0, 0.0001, 1.6524, 110.0, 330.0},
    {"vinyl_tile", 3.62, 0.0, 0.0051, 0.8422, 1.0, 40.0},
    {"carpet_tile", 2.08, 0.0, 0.0009, 0.8200, 1.0, 40.0},
    {"asphalt_concrete", 4.83, 0.0, 0.0108, 1.3969, 1.0, 40.0},
    {"metal", 1.0, 0.0, 1e7, 0.0, 1.0, 100.0},
    {"very_dry_ground", 3.0, 0.0, 0.00015, 2.52, 1.0, 10.0},
    {"medium_dry_ground", 15.0, -0.1, 0.035, 1.63, 1.0, 10.0},
    {"wet_ground", 30.0, -0.4, 0.15, 1.30, 1.0, 10.0},
}};

constexpr double kHertzPerGigahertz = 1e9;  // [Hz/GHz]: the formulas of ITU-R P.2040-4 take GHz

}  // namespace

Complex<double> complex_permittivity(const RadioMaterial& material, double frequency_hz) {
  const double omega = 2.0 * std::numbers::pi * frequency_hz;
  return {material.relative_permittivity, -material.conductivity / (omega * kVacuumPermittivity)};
}

std::span<const std::string> itu_material_names() {
  // The materials of ITU-R P.2040-4, each once.
  static const std::vector<std::string> kNames = [] {
    std::vector<std::string> names;
    for (const ItuRow& row : kItuTable) {
      if (std::find(names.begin(), names.end(), row.name) == names.end()) {
        names.emplace_back(row.name);
      }
    }
    return names;
  }();
  return kNames;
}

Expected<RadioMaterial> itu_material(std::string_view name, double frequency_hz, double thickness) {
  const double f = frequency_hz / kHertzPerGigahertz;
  std::string covered;
  for (const ItuRow& row : kItuTable) {
    if (row.name != name) {
      continue;
    }
    if (f >= row.low_ghz && f <= row.high_ghz) {
      return RadioMaterial{
          std::string(name), row.a * std::pow(f, row.b), row.c * std::pow(f, row.d), thickness};
    }
    covered += (covered.empty() ? "" : " and ") + six_digit_text(row.low_ghz) + " to " +
               six_digit_text(row.high_ghz) + " GHz";
  }
  if (!covered.empty()) {
    return bad_input("ITU-R P.2040-4 states '" + std::string(name) + "' for " + covered +
                     ", not for " + six_digit_text(f) +
                     " GHz; state relative_permittivity and conductivity instead");
  }
  return bad_input("ITU-R P.2040-4 has no material '" + std::string(name) + "'" +
                   suggestion(name, itu_material_names()));
}

Expected<void> validate(const RadioMaterial& material) {
  const auto refuse = [&](const char* what, double value, const char* wanted) {
    return bad_input("material '" + material.name + "': " + what + " is " + six_digit_text(value) +
                     ", " + wanted);
  };
  if (!std::isfinite(material.relative_permittivity) || material.relative_permittivity < 1.0) {
    return refuse("relative_permittivity", material.relative_permittivity, "must be at least 1");
  }
  if (!std::isfinite(material.conductivity) || material.conductivity < 0.0) {
    return refuse("conductivity", material.conductivity, "must be 0 or more [S/m]");
  }
  if (!(material.thickness > 0.0)) {
    return refuse("thickness", material.thickness, "must be more than 0 [m]");
  }
  const SurfaceScattering& scattering = material.scattering;
  const auto is_share = [](double value) { return value >= 0.0 && value <= 1.0; };
  const auto is_exponent = [](double value) { return value > 0.0 && value <= kMaxAlpha; };
  if (!is_share(scattering.scattering_coefficient)) {
    return refuse("scattering_coefficient", scattering.scattering_coefficient, "must be 0 to 1");
  }
  if (!is_share(scattering.xpd_coefficient)) {
    return refuse("xpd_coefficient", scattering.xpd_coefficient, "must be 0 to 1");
  }
  if (!is_share(scattering.lambda)) {
    return refuse("lambda_", scattering.lambda, "must be 0 to 1");
  }
  if (!is_exponent(scattering.alpha_r)) {
    return refuse("alpha_r", scattering.alpha_r, "must be more than 0 and at most 100");
  }
  if (!is_exponent(scattering.alpha_i)) {
    return refuse("alpha_i", scattering.alpha_i, "must be more than 0 and at most 100");
  }
  return {};
}

}  // namespace rayloc
