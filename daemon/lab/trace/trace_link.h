// trace_link: the paths between two antennas of a scene, their channel and its derivatives.
#pragma once

#include <complex>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "daemon/lab/trace/named_parameters.h"
#include "engine/base/expected.h"
#include "engine/channel/ofdm_grid.h"
#include "engine/scene/scene.h"
#include "engine/trace/diffuse/diffuse_density.h"
#include "engine/trace/diffuse/diffuse_tracer.h"
#include "engine/trace/paths.h"
#include "engine/trace/radio_device.h"
#include "engine/trace/trace_options.h"

namespace rayloc {

struct Link {
  Transmitter transmitter;
  Receiver receiver;
};

struct LinkTraceOptions {
  TraceOptions trace;
  DiffuseOptions diffuse;                // with trace.diffuse
  std::optional<OfdmGrid> tones;         // of the frequency response; empty: none
  std::vector<NamedParameter> gradient;  // parameters of the derivatives; empty: none
};

struct LinkTrace {
  Paths paths;
  OfdmGrid tones;  // of `cfr` and `power`; the carrier alone without LinkTraceOptions::tones
  std::optional<std::vector<std::complex<double>>> cfr;
  // The sum of |h|^2 over the tones, and its derivatives by parameter, in the units of
  // named_parameters.h.
  std::optional<double> power;
  std::vector<std::pair<std::string, double>> gradient;
  std::optional<DiffuseDensity> diffuse;
  std::string note;  // notable property of the link, may be empty
};

// Explains why a link has no path or is probably not the intended one: "the transmitter is inside
// of object 'x', where it receives nothing"; empty if there is no problem.
std::string note_on_ends(const Scene& scene, const Link& link);

// No path is a result with a note. Errors: a scene without rough materials, with trace.diffuse; a
// derivative that the tracer does not have. Thread-safe. REQUIRES: two distinct positions.
Expected<LinkTrace> trace_link(const std::shared_ptr<const Scene>& scene,
                               const Link& link,
                               const LinkTraceOptions& options);

}  // namespace rayloc
