#include "daemon/cli/verbs/report/train_report.h"

#include <cstdio>
#include <string>

namespace rayloc::cli {

void print_trained(const TrainInputs& inputs, const TrainedMethod& trained) {
  for (const std::string& note : inputs.survey.notes) {
    std::fprintf(stderr, "%s\n", note.c_str());
  }
  std::fprintf(stderr,
               "%s was trained in %.1f s:\n",
               std::string(inputs.method->name).c_str(),
               trained.seconds);
  for (const AccessPointTraining& ap : trained.training->access_points) {
    if (trained.training->network) {
      std::fprintf(stderr, "%s: %zu places\n", ap.id.c_str(), ap.points);
      continue;
    }
    std::fprintf(stderr,
                 "%s: %zu points, phases within %.2f rad, %.0f %% outliers, ",
                 ap.id.c_str(),
                 ap.points,
                 ap.sigma_psi,
                 100.0 * ap.outliers);
    if (ap.path_loss) {
      std::fprintf(stderr,
                   "level %.1f dBm at 1 m, exponent %.2f, within %.1f dB\n",
                   ap.path_loss->at_1m_dbm,
                   ap.path_loss->exponent,
                   ap.path_loss->sigma_db);
    } else {
      std::fprintf(stderr,
                   "no level: no [[transmitter]] of the survey has constant_power = true\n");
    }
  }
  if (trained.held_out) {
    std::fprintf(stderr,
                 "%zu points held out: median error %.2f m, %.0f %% in their 95 %% regions\n",
                 trained.held_out->n,
                 trained.held_out->median_m,
                 100.0 * trained.held_out->coverage_95.value_or(0.0));
  }
}

}  // namespace rayloc::cli
