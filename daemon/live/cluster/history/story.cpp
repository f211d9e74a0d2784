#include "daemon/live/cluster/history/story.h"

#include <utility>

#include "daemon/live/cluster/cluster_names.h"
#include "daemon/live/cluster/gateway_role.h"
#include "daemon/live/cluster/sealed_message.h"

namespace rayloc {
namespace {

Expected<Chapter> begun(const v1::OutputRecord& record) {
  auto start = start_of(record.begin());
  RAYLOC_TRY(start);
  Chapter chapter;
  chapter.start = *std::move(start);
  chapter.start.generation = record.generation();
  chapter.begin = record.begin();
  chapter.from = chapter.done = time_of_us(record.begin().done_us());
  return chapter;
}

}  // namespace

Expected<std::vector<Chapter>> read_story(Broker& broker, const std::string& site) {
  const std::string stream(kOutputStream);
  const Expected<StreamState> state = broker.stream_state(stream);
  RAYLOC_TRY(state);
  std::vector<Chapter> story;
  OutputOrder order;
  for (std::uint64_t sequence = state->first; sequence <= state->last; ++sequence) {
    auto message = broker.get(stream, sequence);
    RAYLOC_TRY(message);
    v1::OutputRecord record;
    if (!*message || (*message)->subject != output_subject(site) ||
        !unseal((*message)->data, record) || !order.is_next(record)) {
      continue;
    }
    if (record.has_begin()) {
      auto chapter = begun(record);
      RAYLOC_TRY(chapter);
      story.push_back(*std::move(chapter));
    } else if (!story.empty() && story.back().start.generation == record.generation()) {
      Chapter& chapter = story.back();
      chapter.done = time_of_us(record.output().done_us());
      for (v1::OutputItem& item : *record.mutable_output()->mutable_items()) {
        chapter.items.push_back(std::move(item));
      }
    }
  }
  return story;
}

}  // namespace rayloc
