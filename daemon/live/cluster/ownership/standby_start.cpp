#include "daemon/live/cluster/ownership/standby_start.h"

#include <optional>
#include <utility>

#include "daemon/live/cluster/batch.h"
#include "daemon/live/cluster/cluster_names.h"
#include "daemon/live/cluster/ownership/owner_log.h"
#include "daemon/live/cluster/sealed_message.h"

namespace rayloc {
namespace {

// Chosen: the preset retention of streams.
constexpr std::chrono::seconds kMaxToComputeAgain{60};

tl::unexpected<Error> no_owner(const std::string& site) {
  return make_error(ErrorKind::kUnavailable, "site '" + site + "': no owner has spoken");
}

// Returns the Begin of the owner of that record; nothing where the stream of results has lost it.
std::optional<v1::Begin> begin_of(Broker& broker,
                                  const std::string& subject,
                                  const v1::OutputRecord& last) {
  if (last.has_begin()) {
    return last.begin();
  }
  if (last.begin_sequence() == 0) {
    return std::nullopt;
  }
  const auto message = broker.get(std::string(kOutputStream), last.begin_sequence());
  v1::OutputRecord record;
  if (!message || !*message || !unseal((*message)->data, record) || !record.has_begin() ||
      record.generation() != last.generation() || (*message)->subject != subject) {
    return std::nullopt;
  }
  return record.begin();
}

// Returns true if the stream still contains all messages after that place.
bool has_all(const StreamState& stream, const StreamReader::Place& place) {
  return (place.created == Timestamp{} || place.created == stream.created) &&
         place.sequence + 1 >= stream.first;
}

// Time of the first batch after that place; nothing where there is no batch.
std::optional<Timestamp> first_watermark_behind(Broker& broker,
                                                const std::string& site,
                                                const StreamReader::Place& place) {
  const auto message = broker.get(csi_stream(site), place.sequence + 1);
  const auto batch = message && *message ? decode_batch((*message)->data)
                                         : Expected<Batch>(bad_input("there is none"));
  return batch && !batch->parts.empty() ? std::optional(batch->parts.front().watermark)
                                        : std::nullopt;
}

// Returns true if the computation before the first comparison is short enough.
bool is_near(Broker& broker,
             const std::string& site,
             const StreamReader::Place& place,
             const v1::OutputRecord& last) {
  const std::optional<Timestamp> begin = first_watermark_behind(broker, site, place);
  const Timestamp done =
      time_of_us(last.has_output() ? last.output().done_us() : last.begin().done_us());
  return !begin || done == Timestamp::min() || done - *begin < kMaxToComputeAgain;
}

}  // namespace

Expected<StandbyStart> standby_start(Broker& broker, const std::string& site) {
  const auto message = broker.last_of(std::string(kOutputStream), output_subject(site));
  RAYLOC_TRY(message);
  v1::OutputRecord last;
  if (!*message || !unseal((*message)->data, last) || last.output().released()) {
    return no_owner(site);
  }
  const Expected<StreamState> stream = broker.stream_state(csi_stream(site));
  RAYLOC_TRY(stream);
  StandbyStart found;
  if (const std::optional<v1::Begin> begin = begin_of(broker, output_subject(site), last);
      begin && begin->arithmetic() == arithmetic()) {  // others differ in the last digits
    if (auto start = start_of(*begin); start && has_all(*stream, start->resume.place) &&
                                       is_near(broker, site, start->resume.place, last)) {
      found.start = *std::move(start);
      found.start.generation = last.generation();
      return found;
    }
  }
  auto start = start_after(last);
  RAYLOC_TRY(start);
  found.start = *std::move(start);
  found.start.generation = last.generation();
  found.is_late = true;
  return found;
}

}  // namespace rayloc
