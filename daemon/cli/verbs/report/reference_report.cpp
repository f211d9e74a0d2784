#include "daemon/cli/verbs/report/reference_report.h"

#include <cmath>
#include <complex>
#include <cstdio>
#include <numbers>
#include <string>

#include <spdlog/fmt/fmt.h>

namespace rayloc::cli {
namespace {

void print_change(const RoomAccessPoint& ap, const DayChange& change) {
  std::string turns;
  for (std::size_t m = 1; m < ap.rx_chains.size(); ++m) {
    const std::complex<double> turn = change.chains.turn[m] / change.chains.turn[0];
    turns += fmt::format("{} core {} against {} {:+.0f} deg {:+.1f} dB",
                         turns.empty() ? "" : ",",
                         ap.rx_chains[m],
                         ap.rx_chains[0],
                         std::arg(turn) * 180.0 / std::numbers::pi,
                         20.0 * std::log10(std::abs(turn)));
  }
  std::fprintf(stderr,
               "%s: since people were recorded:%s%s; %.1f %% of the empty room is another\n",
               ap.id.c_str(),
               turns.c_str(),
               !change.is_rotated        ? " (as they were)"
               : change.is_today_rotated ? "; today's gains are written"
                                         : "; the calibration's gains are today's",
               100.0 * change.chains.changed);
}

}  // namespace

void print_reference(const ReferenceInputs& inputs, const LearnedReference& learned) {
  for (const DayChange& change : learned.changes) {
    print_change(learned.room.access_points[change.access_point], change);
  }
  for (const PersonReference& reference : learned.references) {
    const SiteTransmitter& stated = *find_transmitter(inputs.site, reference.mac);
    const Vec3d moved = reference.transmitter.position - *stated.position;
    std::fprintf(stderr,
                 "%s: placed (%+.1f, %+.1f, %+.1f) mm from the survey\n",
                 to_string(reference.mac).c_str(),
                 1e3 * moved.x,
                 1e3 * moved.y,
                 1e3 * moved.z);
    for (const PersonLink& link : reference.links) {
      std::fprintf(stderr,
                   "  %s: empty room explained %.2f; a person's echo times %.2f at %.0f deg\n",
                   learned.room.access_points[link.access_point].id.c_str(),
                   link.room_fit,
                   std::abs(link.scale),
                   std::arg(link.scale) * 180.0 / std::numbers::pi);
    }
  }
  const PersonModel& person = learned.references.front().person;
  std::fprintf(
      stderr,
      "person %s: radius %.3f m, strength variance %g, way variance %g, front %g m, diffuse %g, "
      "noise %g, "
      "likelihood_exponent %g\n",
      learned.points > 0 ? ("from " + std::to_string(learned.points) + " places").c_str()
                         : "as stated (no --people)",
      person.body.semi_axes[0],
      person.strength_variance,
      person.path_variance,
      person.front_offset_sigma,
      person.diffuse,
      person.noise,
      person.likelihood_exponent);
  if (person.second_person) {
    std::fprintf(stderr,
                 "  a second person is accepted from a log-likelihood of %.1f on, and with two "
                 "access points\n",
                 *person.second_person);
  }
  for (const std::string& note : inputs.notes) {
    std::fprintf(stderr, "%s\n", note.c_str());
  }
  for (const RefusedInput& refused : learned.refused) {
    std::fprintf(stderr, "not used: %s: %s\n", refused.what.c_str(), refused.reason.c_str());
  }
}

}  // namespace rayloc::cli
