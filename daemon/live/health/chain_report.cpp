#include "daemon/live/health/chain_report.h"

#include <cmath>
#include <complex>

#include "daemon/messages/proto_time.h"
#include "engine/base/constants.h"

namespace rayloc {
namespace {

v1::ChainKnowledge knowledge_proto(ChainKnowledge knowledge) {
  switch (knowledge) {
    case ChainKnowledge::kLearning:
      return v1::CHAIN_KNOWLEDGE_LEARNING;
    case ChainKnowledge::kLearned:
      return v1::CHAIN_KNOWLEDGE_LEARNED;
    case ChainKnowledge::kAsCalibrated:
      break;
  }
  return v1::CHAIN_KNOWLEDGE_AS_CALIBRATED;
}

}  // namespace

v1::ChainReport chain_report(const ChainState& state, const RoomModel& room) {
  const RoomAccessPoint& ap = room.access_points[state.access_point];
  v1::ChainReport report;
  report.set_access_point(ap.id);
  report.set_knowledge(knowledge_proto(state.knowledge));
  if (state.since != Timestamp()) {
    *report.mutable_since() = to_proto(state.since);
  }
  report.set_bursts(state.bursts);
  report.set_bursts_needed(state.bursts_needed);
  if (state.knowledge == ChainKnowledge::kLearned) {
    const auto& factor = state.factors.factor;
    for (std::size_t m = 1; m < factor.size(); ++m) {
      v1::ChainTurn& turn = *report.add_turns();
      turn.set_core(ap.rx_chains[m]);
      turn.set_phase_deg(kDegreesPerRadian * std::arg(factor[m] / factor[0]));
      turn.set_phase_sigma_deg(kDegreesPerRadian * state.factors.sigma[m]);
      turn.set_level_db(20.0 * std::log10(std::abs(factor[m])));
    }
  }
  return report;
}

}  // namespace rayloc
