#include "daemon/cli/calibration/chain_report.h"

#include <cstdio>
#include <string>

#include <spdlog/fmt/fmt.h>

namespace rayloc::cli {
namespace {

std::string source_text(const RechainedAccessPoint& one) {
  if (one.learned_from > 0) {
    return fmt::format("learned from {} bursts of devices", one.learned_from);
  }
  return fmt::format("{} known places, fit {:.3f}{}",
                     one.points,
                     one.fit.value_or(0.0),
                     one.usual_fit ? fmt::format(" ({:.3f} when calibrated)", *one.usual_fit)
                                   : "; no report of the calibration to compare with");
}

}  // namespace

void print_chains(const RechainResult& result, bool with_refused) {
  if (with_refused) {
    for (const RefusedInput& one : result.refused) {
      std::fprintf(stderr, "%s: %s\n", one.what.c_str(), one.reason.c_str());
    }
  }
  for (const RechainedAccessPoint& one : result.access_points) {
    std::fprintf(stderr, "%s: %s\n", one.id.c_str(), source_text(one).c_str());
    for (const ChainChange& chain : one.chains) {
      std::fprintf(stderr,
                   "  core %d against %d: phase %.1f -> %.1f deg (sigma %.1f), gain %.2f -> %.2f "
                   "dB\n",
                   chain.rx_chain,
                   chain.against,
                   chain.before.phase_deg,
                   chain.after.phase_deg,
                   chain.sigma.phase_deg,
                   chain.before.gain_db,
                   chain.after.gain_db);
    }
  }
}

}  // namespace rayloc::cli
