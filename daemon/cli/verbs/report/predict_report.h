// Prints a prediction and proposals on standard output, and their progress on a terminal.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "daemon/base/observer.h"
#include "daemon/lab/predict/predict_site.h"
#include "daemon/lab/predict/proposals.h"

namespace rayloc::cli {

// A line of standard error with the progress, if that is a terminal.
class PredictionProgress {
 public:
  explicit PredictionProgress(bool quiet);
  PredictionProgress(const PredictionProgress&) = delete;
  PredictionProgress& operator=(const PredictionProgress&) = delete;

  const Observer& observer() const { return observer_; }
  void clear();

 private:
  void show(double share, const std::string& stage);

  bool is_silent_;
  bool is_shown_ = false;
  Observer observer_;
};

// `devices`: the number of devices that share the channel.
void print_prediction(const SitePrediction& predicted, std::size_t devices);

// A table, a line per proposal.
void print_proposals(const std::vector<Proposal>& found);

}  // namespace rayloc::cli
