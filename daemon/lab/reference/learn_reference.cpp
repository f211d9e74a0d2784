#include "daemon/lab/reference/learn_reference.h"

#include <algorithm>
#include <utility>

#include "daemon/lab/calibrate/survey_clock.h"
#include "daemon/lab/reference/measured_links.h"
#include "daemon/lab/reference/people_day.h"
#include "daemon/site/model/reference_file.h"
#include "engine/person/calibrate/person_certainty.h"
#include "engine/person/calibrate/person_fit.h"

namespace rayloc {
namespace {

Transmitter surveyed_place(const SiteTransmitter& transmitter) {
  return {{*transmitter.position, {}, transmitter.pattern, transmitter.polarization}};
}

// Holds the state of one call of learn_reference().
class ReferenceLearner {
 public:
  ReferenceLearner(const ReferenceInputs& inputs, const Observer& observer)
      : inputs_(inputs), observer_(observer), people_room_(inputs.room) {
    learned_.room = inputs.room;
  }
  Expected<LearnedReference> run();

 private:
  Expected<void> learn_empty_room();
  Expected<void> learn_two_days();
  Expected<void> add_reference(const MacAddress& mac,
                               const Transmitter& surveyed,
                               const std::vector<EmptyRoom>& received);
  Expected<void> learn_person();
  Expected<void> fit_points(const std::vector<CsiFrame>& frames, PersonReference& reference);
  void finish();

  const ReferenceInputs& inputs_;
  const Observer& observer_;
  RoomModel people_room_;               // room when people were recorded, with other chain gains
  std::vector<ReceivedDays> received_;  // by reference, if people were recorded on another day
  InputLog log_;
  LearnedReference learned_;
};

Expected<void> ReferenceLearner::add_reference(const MacAddress& mac,
                                               const Transmitter& surveyed,
                                               const std::vector<EmptyRoom>& received) {
  auto reference = fit_empty_room(people_room_, surveyed, received);
  RAYLOC_TRY(reference);
  reference->mac = mac;
  reference->person = stated_person(inputs_.site);
  reference->area = stated_area(inputs_.site);
  learned_.references.push_back(*std::move(reference));
  return {};
}

Expected<void> ReferenceLearner::learn_empty_room() {
  for (const auto& [mac, frames] : inputs_.empty) {
    const auto received = receive_empty_room(inputs_.room, frames, inputs_.occupied, log_);
    RAYLOC_TRY(received);
    const Transmitter surveyed = surveyed_place(*find_transmitter(inputs_.site, mac));
    RAYLOC_TRY(add_reference(mac, surveyed, *received));
  }
  return {};
}

// The references are those of the day of the people until all values are learned.
Expected<void> ReferenceLearner::learn_two_days() {
  std::vector<MacAddress> macs;
  std::vector<ReceivedDays> both;
  for (const auto& [mac, frames] : inputs_.empty) {
    const auto before = inputs_.people_empty.find(mac);
    if (before == inputs_.people_empty.end()) {
      log_.refused.push_back({to_string(mac), "not in the recordings of --people-empty"});
      continue;
    }
    auto today = receive_empty_room(inputs_.room, frames, inputs_.occupied, log_);
    RAYLOC_TRY(today);
    auto people = receive_empty_room(inputs_.room, before->second, false, log_);
    if (!people) {
      return bad_input("--people-empty: " + people.error().message);
    }
    macs.push_back(mac);
    both.push_back({surveyed_place(*find_transmitter(inputs_.site, mac)),
                    *std::move(people),
                    *std::move(today)});
  }
  auto days = separate_days(inputs_.room, both);
  RAYLOC_TRY(days);
  learned_.room = std::move(days->today);
  people_room_ = std::move(days->people);
  learned_.changes = std::move(days->changes);
  for (std::size_t i = 0; i < macs.size(); ++i) {
    ReceivedDays& received = days->received[i];
    if (received.today.empty()) {
      log_.refused.push_back({to_string(macs[i]), "no access point received it on both days"});
      continue;
    }
    RAYLOC_TRY(add_reference(macs[i], received.surveyed, received.people));
    received_.push_back(std::move(received));
  }
  return {};
}

Expected<void> ReferenceLearner::fit_points(const std::vector<CsiFrame>& frames,
                                            PersonReference& reference) {
  const MeasuredPoints measured = receive_points(people_room_, reference, inputs_, log_);
  if (measured.points.empty()) {
    return bad_input(
        "--people: received " + to_string(reference.mac) + " " +
        explain_other_times(inputs_.points_file, inputs_.points, DeviceTrace::of(frames)));
  }
  const bool is_same_day = inputs_.people_empty.empty();
  if (is_same_day && measured.points.size() >= kMinPersonPoints) {
    RAYLOC_TRY(check_people_day(people_room_, reference, measured.frames));
  }
  auto fit = fit_person(people_room_, reference, measured.points);
  if (!fit) {
    return bad_input(inputs_.points_file + ": " + fit.error().message);
  }
  if (is_same_day) {
    RAYLOC_TRY(check_echo_factors(people_room_, fit->reference, measured.points));
  }
  const auto certainty = fit_person_certainty(people_room_, *fit, measured.points, measured.frames);
  RAYLOC_TRY(certainty);
  reference = std::move(fit->reference);
  reference.person.likelihood_exponent = certainty->likelihood_exponent;
  reference.person.second_person = certainty->second_person;
  learned_.points = std::max(learned_.points, fit->points);
  return {};
}

// Each transmitter that has data of people gets the person model fitted to them.
Expected<void> ReferenceLearner::learn_person() {
  const auto count = static_cast<double>(learned_.references.size() + 1);
  double done = 1.0;
  for (PersonReference& reference : learned_.references) {
    observer_.progress(done / count, "person, " + to_string(reference.mac));
    done += 1.0;
    const auto frames = inputs_.people.find(reference.mac);
    if (frames == inputs_.people.end()) {
      log_.refused.push_back({to_string(reference.mac), "not in the recordings of people"});
      continue;
    }
    RAYLOC_TRY(fit_points(frames->second, reference));
  }
  return {};
}

// Moves the references to today, and names their content.
void ReferenceLearner::finish() {
  std::vector<PersonReference>& references = learned_.references;
  for (std::size_t i = 0; i < received_.size(); ++i) {
    references[i] =
        moved_to_today(learned_.room.grid, std::move(references[i]), received_[i].today);
  }
  const std::string id = log_.content.text();
  for (PersonReference& reference : references) {
    reference.id = id;
  }
  if (has_rotated_chains(learned_.changes)) {
    learned_.room.calibration_id = id;
  }
  learned_.refused = std::move(log_.refused);
}

Expected<LearnedReference> ReferenceLearner::run() {
  observer_.progress(0.0, "empty room");
  log_.content.add(inputs_.room.calibration_id);
  auto done = inputs_.people_empty.empty() ? learn_empty_room() : learn_two_days();
  if (done && !inputs_.people.empty()) {
    done = learn_person();
  }
  RAYLOC_TRY(done);
  finish();
  return std::move(learned_);
}

}  // namespace

bool has_rotated_chains(const std::vector<DayChange>& changes) {
  return std::any_of(changes.begin(), changes.end(), [](const DayChange& one) {
    return one.is_rotated && one.is_today_rotated;
  });
}

Expected<LearnedReference> learn_reference(const ReferenceInputs& inputs,
                                           const Observer& observer) {
  return ReferenceLearner(inputs, observer).run();
}

}  // namespace rayloc
