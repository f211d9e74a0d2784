// Prints a prediction and proposals on standard output.
#pragma once

#include <cstddef>
#include <vector>

#include "daemon/lab/predict/predict_site.h"
#include "daemon/lab/predict/proposals.h"

namespace rayloc::cli {

// `devices`: the number of devices that share the channel.
void print_prediction(const SitePrediction& predicted, std::size_t devices);

// A table, a line per proposal.
void print_proposals(const std::vector<Proposal>& found);

}  // namespace rayloc::cli
