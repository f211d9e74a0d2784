#include "engine/trace/path_tracer.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "engine/base/constants.h"
#include "engine/base/parallel.h"
#include "engine/trace/diffraction/edge_finder.h"
#include "engine/trace/diffraction/edge_pair_finder.h"
#include "engine/trace/evaluate_path.h"
#include "engine/trace/images/image_tree.h"
#include "engine/trace/interaction_finder.h"
#include "engine/trace/path_differentiator.h"
#include "engine/trace/round_trips.h"
#include "engine/trace/trace_context.h"

namespace rayloc {
namespace {

bool canonical_order(const Path& a, const Path& b) {
  if (a.interactions.size() != b.interactions.size()) {
    return a.interactions.size() < b.interactions.size();
  }
  return std::lexicographical_compare(a.interactions.begin(),
                                      a.interactions.end(),
                                      b.interactions.begin(),
                                      b.interactions.end(),
                                      [](const Interaction& x, const Interaction& y) {
                                        return std::tie(x.surface, x.kind, x.edge, x.along_face_n) <
                                               std::tie(y.surface, y.kind, y.edge, y.along_face_n);
                                      });
}

bool at_the_same_places(const Path& a, const Path& b) {
  constexpr double kSamePlace = 1e-9;   // [m]
  constexpr double kSameDelay = 1e-15;  // [s], about 300 times kSamePlace in delay
  return std::abs(a.tau - b.tau) < kSameDelay &&
         std::equal(a.interactions.begin(),
                    a.interactions.end(),
                    b.interactions.begin(),
                    b.interactions.end(),
                    [](const Interaction& x, const Interaction& y) {
                      return x.kind == y.kind && x.along_face_n == y.along_face_n &&
                             norm(x.position - y.position) < kSamePlace;
                    });
}

// Where faces of two objects coincide, the first one acts.
void drop_repeated(std::vector<Path>& paths) {
  std::vector<Path> kept;
  for (Path& path : paths) {
    const bool repeated = std::any_of(
        kept.begin(), kept.end(), [&](const Path& p) { return at_the_same_places(p, path); });
    if (!repeated) {
      kept.push_back(std::move(path));
    }
  }
  paths = std::move(kept);
}

// The path over these interactions.
Path evaluate(const TraceContext& context,
              const std::vector<Interaction>& interactions,
              const LinkEnd<double>& transmitter,
              const LinkEnd<double>& receiver) {
  const PathCoefficient<double> found = evaluate_path<double>(
      context,
      interactions,
      [&](std::uint32_t surface) -> const Facet<double>& { return context.facets[surface]; },
      transmitter,
      receiver);
  return {found.a, found.length / kSpeedOfLight, found.departure, -found.arrival, interactions};
}

}  // namespace

PathTracer::PathTracer(std::shared_ptr<const Scene> scene, const TraceOptions& options)
    : context_(std::make_shared<const TraceContext>(std::move(scene), options)) {}

const Scene& PathTracer::scene() const { return *context_->scene; }

const TraceOptions& PathTracer::options() const { return context_->options; }

double PathTracer::wavelength() const { return context_->wavelength; }

Paths PathTracer::trace(const Transmitter& transmitter, const Receiver& receiver) const {
  return at(receiver).trace(transmitter);
}

ReceiverTracer PathTracer::at(const Receiver& receiver) const {
  auto tree =
      std::make_shared<const ImageTree>(*context_->scene, receiver.position, context_->options);
  return {context_, receiver, std::move(tree), 0};
}

std::vector<ReceiverTracer> PathTracer::at(std::span<const Receiver> receivers) const {
  constexpr double kNear = 0.25;  // [m], from the first receiver
  std::vector<Vec3d> roots;
  for (const Receiver& receiver : receivers) {
    roots.push_back(receiver.position);
  }
  const bool are_near = std::all_of(roots.begin(), roots.end(), [&](const Vec3d& root) {
    return norm(root - roots.front()) <= kNear;
  });
  std::vector<ReceiverTracer> tracers;
  if (are_near && roots.size() > 1 && roots.size() <= kMaxRoots) {
    if (auto tree = ImageTree::shared(*context_->scene, roots, context_->options)) {
      const auto shared = std::make_shared<const ImageTree>(std::move(*tree));
      for (std::size_t i = 0; i < receivers.size(); ++i) {
        tracers.push_back({context_, receivers[i], shared, i});
      }
      return tracers;
    }
  }
  std::vector<std::optional<ReceiverTracer>> made(receivers.size());
  parallel_for(receivers.size(), 1, [&](std::size_t i) { made[i] = at(receivers[i]); });
  for (auto& one : made) {
    tracers.push_back(std::move(*one));
  }
  return tracers;
}

ReceiverTracer::ReceiverTracer(std::shared_ptr<const TraceContext> context,
                               Receiver receiver,
                               std::shared_ptr<const ImageTree> tree,
                               std::size_t root)
    : context_(std::move(context)),
      receiver_(std::move(receiver)),
      tree_(std::move(tree)),
      root_(root) {
  if (context_->options.diffraction) {
    lit_edges_ = std::make_shared<const LitEdges>(*context_, tree_, root_);
  }
}

Paths ReceiverTracer::trace(const Transmitter& transmitter) const {
  return trace(transmitter, lit_by(transmitter).get());
}

std::shared_ptr<const LitEdges> ReceiverTracer::lit_by(const Transmitter& transmitter) const {
  if (!context_->options.diffraction) {
    return nullptr;
  }
  return std::make_shared<const LitEdges>(*context_, edge_tree(*context_, transmitter.position), 0);
}

Paths ReceiverTracer::trace(const Transmitter& transmitter, const LitEdges* lit) const {
  const LinkEnd<double> from = link_end(transmitter);
  const LinkEnd<double> to = link_end(receiver_);
  // A count, chosen: enough for a room with three reflections.
  constexpr std::size_t kUsualPaths = 64;
  InteractionFinder finder(context_);
  std::vector<Interaction> interactions;
  std::vector<Path> paths;
  paths.reserve(kUsualPaths);
  tree_->visit_chains(root_, transmitter.position, [&](const SpecularChain& chain) {
    if (!finder.find(chain, from, to, interactions)) {
      return;
    }
    const auto add = [&](const std::vector<Interaction>& met) {
      paths.push_back(evaluate(*context_, met, from, to));
    };
    add(interactions);
    if (context_->options.transmission && context_->options.softness == 0.0) {
      visit_round_trips(*context_, interactions, 0, add);
    }
  });
  if (lit != nullptr) {
    EdgeFinder(context_).visit(*lit, *lit_edges_, [&](const std::vector<Interaction>& met) {
      paths.push_back(evaluate(*context_, met, from, to));
    });
    if (context_->options.double_diffraction) {
      EdgePairFinder(context_).visit(*lit, *lit_edges_, [&](const std::vector<Interaction>& met) {
        paths.push_back(evaluate(*context_, met, from, to));
      });
    }
  }
  std::sort(paths.begin(), paths.end(), canonical_order);
  if (context_->has_covers && context_->options.softness == 0.0) {
    drop_repeated(paths);
  }
  return Paths(std::move(paths));
}

Expected<PathDerivatives> ReceiverTracer::differentiate(
    const Transmitter& transmitter,
    const Paths& paths,
    std::span<const Parameter> parameters) const {
  return PathDifferentiator(*context_, transmitter, receiver_).differentiate(paths, parameters);
}

}  // namespace rayloc
