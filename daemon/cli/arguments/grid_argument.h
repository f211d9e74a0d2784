// `--cfr CENTRE,SPACING,COUNT`: the tones of a frequency response.
#pragma once

#include <string>

#include "engine/base/expected.h"
#include "engine/channel/ofdm_grid.h"

namespace rayloc::cli {

// The tones CENTRE + (j - COUNT / 2) SPACING [Hz], as those of 802.11 are numbered. Errors are of
// kind kUsage.
Expected<OfdmGrid> parse_grid(const std::string& text);

}  // namespace rayloc::cli
