#include "daemon/live/cluster/site_resume.h"

#include <algorithm>

#include "daemon/live/cluster/shed_rule.h"

namespace rayloc {

v1::StreamPosition position_message(const SiteResume& resume) {
  v1::StreamPosition message;
  message.set_stream_created_ns(resume.place.created.time_since_epoch().count());
  message.set_sequence(resume.place.sequence);
  message.set_shed_level(resume.shed_level);
  for (const auto& [name, position] : resume.nodes) {
    v1::NodePosition& node = *message.add_nodes();
    node.set_node(name);
    node.set_epoch(position.epoch);
    node.set_number(position.number);
    node.mutable_past_epochs()->Add(position.past_epochs.begin(), position.past_epochs.end());
    node.set_silent(resume.silent.count(name) != 0);
  }
  return message;
}

SiteResume resume_of(const v1::StreamPosition& message) {
  SiteResume resume;
  resume.place.created = Timestamp(Duration(message.stream_created_ns()));
  resume.place.sequence = message.sequence();
  resume.shed_level = std::min(message.shed_level(), kMaxShed);
  for (const v1::NodePosition& node : message.nodes()) {
    resume.nodes[node.node()] = {
        node.epoch(), node.number(), {node.past_epochs().begin(), node.past_epochs().end()}};
    if (node.silent()) {
      resume.silent.insert(node.node());
    }
  }
  return resume;
}

}  // namespace rayloc
