#include "daemon/lab/trace/trace_report.h"

#include <algorithm>
#include <cmath>

#include <spdlog/fmt/fmt.h>
#include <nlohmann/json.hpp>

#include "engine/base/constants.h"
#include "engine/trace/interactions/interaction.h"

namespace rayloc {
namespace {

std::string kinds_of(const Path& path) {
  std::string kinds;
  for (const Interaction& interaction : path.interactions) {
    kinds += letter_of(interaction.kind);
  }
  return kinds;
}

const std::string& object_name(const Scene& scene, const Interaction& interaction) {
  return scene.objects()[interaction.object].name;
}

double power_db(const Path& path) { return 10.0 * std::log10(abs2(path.a)); }

std::string number(double value) { return fmt::format("{:.17g}", value); }

// The name comes from the scene file: invalid UTF-8 is replaced.
std::string quoted(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

// "[a,b]", with each element converted by `text`.
template <typename Range, typename ToText>
std::string array(const Range& range, ToText to_text) {
  std::string text = "[";
  for (const auto& element : range) {
    text += (text.size() > 1 ? "," : "") + to_text(element);
  }
  return text + "]";
}

std::string path_json(const Path& path, const Scene& scene) {
  const auto object = [&](const Interaction& i) { return quoted(object_name(scene, i)); };
  const auto vertex = [](const Interaction& i) {
    return fmt::format(
        "[{},{},{}]", number(i.position.x), number(i.position.y), number(i.position.z));
  };
  return fmt::format(
      "{{\"kinds\":\"{}\",\"objects\":{},\"vertices\":{},\"tau\":{},\"a\":[{},{}],"
      "\"angles\":[{},{},{},{}]}}",
      kinds_of(path),
      array(path.interactions, object),
      array(path.interactions, vertex),
      number(path.tau),
      number(path.a.re),
      number(path.a.im),
      number(path.theta_t()),
      number(path.phi_t()),
      number(path.theta_r()),
      number(path.phi_r()));
}

std::string path_line(const Path& path, const Scene& scene) {
  std::string objects;
  for (const Interaction& interaction : path.interactions) {
    objects += (objects.empty() ? "" : ", ") + object_name(scene, interaction);
  }
  return fmt::format(
      "{:<6} {:>10.2f} {:>11.3f} {:>10.3f} {:>8.2f} {:>8.2f} {:>8.2f} {:>8.2f}  {}\n",
      path.interactions.empty() ? "-" : kinds_of(path),
      power_db(path),
      path.tau * 1e9,
      path.tau * kSpeedOfLight,
      path.theta_t() * kDegreesPerRadian,
      path.phi_t() * kDegreesPerRadian,
      path.theta_r() * kDegreesPerRadian,
      path.phi_r() * kDegreesPerRadian,
      objects);
}

// Power by delay, in bins of a nanosecond from the first echo on.
std::string diffuse_json(const DiffuseDensity& density) {
  constexpr double kBin = 1e-9;          // [s]
  constexpr double kMaxBins = 10'000.0;  // a count, chosen: 3 km
  double first = density.echoes().empty() ? 0.0 : density.echoes().front().tau;
  double last = first;
  for (const DiffuseEcho& echo : density.echoes()) {
    first = std::min(first, echo.tau);
    last = std::max(last, echo.tau);
  }
  const PowerDelay found = density.power_delay();
  const double bins = std::min(std::floor((last - first) / kBin) + 1.0, kMaxBins);
  return fmt::format(
      R"({{"power":{},"mean_delay":{},"delay_spread":{},"first":{},"step":{},"profile":{}}})",
      number(found.power),
      number(found.mean_delay),
      number(found.delay_spread),
      number(first),
      number(kBin),
      array(density.profile(first, kBin, static_cast<std::size_t>(bins)), number));
}

}  // namespace

std::string trace_json(const LinkTrace& traced, const Scene& scene) {
  std::string text =
      fmt::format(R"({{"frequency":{},"paths":{})",
                  number(scene.carrier_hz()),
                  array(traced.paths, [&](const Path& path) { return path_json(path, scene); }));
  if (traced.cfr) {
    text += ",\"cfr\":" + array(*traced.cfr, [](const std::complex<double>& h) {
              return fmt::format("[{},{}]", number(h.real()), number(h.imag()));
            });
  }
  if (traced.power) {
    text += ",\"power\":" + number(*traced.power) + ",\"gradient\":{";
    for (std::size_t i = 0; i < traced.gradient.size(); ++i) {
      const auto& [name, value] = traced.gradient[i];
      text += (i > 0 ? "," : "") + quoted(name) + ":" + number(value);
    }
    text += "}";
  }
  if (traced.diffuse) {
    text += ",\"diffuse\":" + diffuse_json(*traced.diffuse);
  }
  return text + (traced.note.empty() ? "" : ",\"note\":" + quoted(traced.note)) + "}\n";
}

std::string trace_table(const LinkTrace& traced, const Scene& scene) {
  std::vector<const Path*> strongest_first;
  for (const Path& path : traced.paths) {
    strongest_first.push_back(&path);
  }
  std::stable_sort(strongest_first.begin(), strongest_first.end(), [](auto* a, auto* b) {
    return abs2(a->a) > abs2(b->a);
  });
  std::string text =
      fmt::format("{} paths at {:.6g} GHz\n", traced.paths.size(), scene.carrier_hz() / 1e9);
  if (!strongest_first.empty()) {
    text += fmt::format("{:<6} {:>10} {:>11} {:>10} {:>8} {:>8} {:>8} {:>8}  {}\n",
                        "kinds",
                        "power [dB]",
                        "delay [ns]",
                        "length [m]",
                        "theta_t",
                        "phi_t",
                        "theta_r",
                        "phi_r [deg]",
                        "objects");
  }
  for (const Path* path : strongest_first) {
    text += path_line(*path, scene);
  }
  if (traced.cfr) {
    double power = 0.0;
    for (const std::complex<double>& h : *traced.cfr) {
      power += std::norm(h);
    }
    text += fmt::format("mean of |h|^2 over {} tones: {:.2f} dB\n",
                        traced.cfr->size(),
                        10.0 * std::log10(power / static_cast<double>(traced.cfr->size())));
  }
  if (traced.diffuse) {
    const PowerDelay found = traced.diffuse->power_delay();
    text += fmt::format("scattered: {:.2f} dB, mean delay {:.2f} ns, delay spread {:.2f} ns\n",
                        10.0 * std::log10(found.power),
                        found.mean_delay * 1e9,
                        found.delay_spread * 1e9);
  }
  for (const auto& [name, value] : traced.gradient) {
    text += fmt::format("d power / d {:<24} {:.9g}\n", name, value);
  }
  return text;
}

}  // namespace rayloc
