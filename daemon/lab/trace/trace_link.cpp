#include "daemon/lab/trace/trace_link.h"

#include "daemon/site/scene/solid_around.h"
#include "engine/trace/diffuse/rough_materials.h"
#include "engine/trace/path_tracer.h"

namespace rayloc {
namespace {

Expected<void> add_gradient(const ReceiverTracer& tracer,
                            const Transmitter& transmitter,
                            const std::vector<NamedParameter>& named,
                            LinkTrace& traced) {
  std::vector<Parameter> parameters;
  parameters.reserve(named.size());
  for (const NamedParameter& each : named) {
    parameters.push_back(each.parameter);
  }
  const auto derivatives = tracer.differentiate(transmitter, traced.paths, parameters);
  RAYLOC_TRY(derivatives);
  std::vector<std::complex<double>> adjoint = traced.paths.cfr(traced.tones);
  traced.power = 0.0;
  for (std::complex<double>& h : adjoint) {
    *traced.power += std::norm(h);
    h *= 2.0;
  }
  const std::vector<double> gradient =
      derivatives->loss_gradient(traced.paths, traced.tones, adjoint);
  for (std::size_t i = 0; i < named.size(); ++i) {
    traced.gradient.emplace_back(named[i].name, gradient[i]);
  }
  return {};
}

}  // namespace

std::string note_on_ends(const Scene& scene, const Link& link) {
  std::string note;
  for (const auto& [name, position] : {std::pair("transmitter", link.transmitter.position),
                                       std::pair("receiver", link.receiver.position)}) {
    if (const auto around = solid_around(scene, position)) {
      note += (note.empty() ? "" : "; ") + std::string("the ") + name + " is inside of object '" +
              scene.objects()[*around].name + "'";
    }
  }
  return note;
}

Expected<LinkTrace> trace_link(const std::shared_ptr<const Scene>& scene,
                               const Link& link,
                               const LinkTraceOptions& options) {
  const ReceiverTracer tracer = PathTracer(scene, options.trace).at(link.receiver);
  LinkTrace traced;
  traced.paths = tracer.trace(link.transmitter);
  traced.tones = options.tones.value_or(OfdmGrid{scene->carrier_hz(), 0.0, {0}});
  traced.note = note_on_ends(*scene, link);
  if (traced.paths.empty()) {
    traced.note += (traced.note.empty() ? "" : "; ") + std::string("no path");
  }
  if (options.trace.diffuse) {
    RAYLOC_TRY(check_scatters(*scene));
    traced.diffuse = DiffuseTracer(scene, options.trace, options.diffuse)
                         .density(link.transmitter, link.receiver);
  }
  if (options.tones) {
    traced.cfr = traced.paths.cfr(traced.tones);
  }
  if (!options.gradient.empty()) {
    RAYLOC_TRY(add_gradient(tracer, link.transmitter, options.gradient, traced));
  }
  return traced;
}

}  // namespace rayloc
