// `rayloc reference`: records the empty room on the links of the
// fixed transmitters, and the effect of a person on these links.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "daemon/cli/command/verb.h"
#include "daemon/cli/verbs/reference_report.h"
#include "daemon/cli/verbs/verbs.h"
#include "daemon/lab/calibrate/report/refused_input.h"
#include "daemon/lab/calibrate/survey_clock.h"
#include "daemon/lab/recordings/fixed_frames.h"
#include "daemon/site/model/calibration_file.h"
#include "daemon/site/model/reference_file.h"
#include "daemon/site/model/room_model.h"
#include "daemon/site/model/site_copy.h"
#include "daemon/site/scene/scene_notes.h"
#include "daemon/site/survey/time_offset.h"
#include "engine/base/content_hash.h"
#include "engine/person/calibrate/empty_room.h"
#include "engine/person/calibrate/occupied_room.h"
#include "engine/person/calibrate/person_certainty.h"
#include "engine/person/calibrate/person_fit.h"
#include "engine/person/calibrate/two_days.h"
#include "engine/room/preprocess_burst.h"

namespace rayloc::cli {
namespace {

namespace fs = std::filesystem;

// Largest difference between the clocks of access points and survey.
constexpr Duration kReferenceClockSlack = std::chrono::milliseconds(20);
// Number of frames of the empty room averaged for each access point.
constexpr std::size_t kMaxEmptyFrames = 1024;
// Largest change of the channel of an empty room within its recording, as a share of its power.
constexpr double kMaxChange = 0.02;

struct ReferenceOptions {
  std::string site;
  std::vector<std::string> captures;
  std::vector<std::string> people;
  std::string points;
  std::string time_offset = "0";
  std::vector<std::string> people_empty;
  std::string out;
  bool occupied = false;
  bool force = false;
  bool quiet = false;
};

// One run of the verb.
class Reference {
 public:
  explicit Reference(const ReferenceOptions& options) : options_(options) {}
  Expected<void> run();

 private:
  using Frames = std::map<MacAddress, std::vector<CsiFrame>>;

  Expected<void> read();
  Expected<Frames> read_captures(const std::vector<std::string>& arguments);
  Expected<void> learn_empty_room();
  Expected<std::vector<EmptyRoom>> empty_rooms_of(const std::vector<CsiFrame>& frames,
                                                  bool occupied);
  Expected<void> learn_two_days();
  Expected<void> add_reference(const MacAddress& mac,
                               const Transmitter& surveyed,
                               const std::vector<EmptyRoom>& received);
  Expected<void> learn_person();
  std::vector<PersonSpot> spots_of(const PersonReference& reference,
                                   const std::vector<CsiFrame>& frames,
                                   std::vector<std::vector<CsiFrame>>& frames_of_spot);
  Expected<std::string> calibration_text();
  Expected<void> write();

  const ReferenceOptions& options_;
  Site site_;
  RoomModel room_;         // today's room
  RoomModel people_room_;  // room when people were recorded, with other chain gains
  Frames empty_;
  Frames people_empty_;
  Frames people_;
  std::vector<ReceivedDays> received_;  // by reference, if people were recorded on another day
  std::vector<DayChange> changes_;
  std::vector<SurveyPoint> points_;
  std::vector<PersonReference> references_;
  std::size_t spots_ = 0;
  ContentHash content_;
  std::vector<RefusedInput> refused_;
  std::vector<std::string> notes_;  // from the recordings
};

Expected<Reference::Frames> Reference::read_captures(const std::vector<std::string>& arguments) {
  const auto captures =
      resolve_captures(arguments, access_point_ids(site_), PerAccessPoint::kSeveral);
  if (!captures) {
    return tl::make_unexpected(captures.error());
  }
  auto frames = read_fixed_frames(site_, *captures, notes_);
  if (!frames) {
    return tl::make_unexpected(std::move(frames.error()));
  }
  for (const RecordingArgument& recording : recordings_of(*captures)) {
    const int index = *find_access_point(site_, recording.access_point);
    const bool received = std::any_of(frames->begin(), frames->end(), [&](const auto& entry) {
      return std::any_of(entry.second.begin(), entry.second.end(), [&](const CsiFrame& frame) {
        return frame.access_point == index;
      });
    });
    if (!received) {
      std::string message = files_text(recording) + ": access point '" + recording.access_point +
                            "' received no fixed transmitter of the site; give a recording of one "
                            "of the [[transmitter]] with role = \"fixed\"";
      for (const std::string& note : notes_) {
        message += "\n" + note;
      }
      return bad_input(message);
    }
  }
  return frames;
}

Expected<void> Reference::read() {
  auto site = load_calibrated_site(options_.site,
                                   ", and a person is found in a calibrated room only: "
                                   "run `rayloc calibrate` first",
                                   options_.out,
                                   options_.force);
  if (!site) {
    return tl::make_unexpected(std::move(site.error()));
  }
  site_ = *std::move(site);
  if (std::none_of(site_.transmitters.begin(), site_.transmitters.end(), [](const auto& one) {
        return one.role == TransmitterRole::kFixed;
      })) {
    return make_error(ErrorKind::kConfiguration,
                      options_.site +
                          ": states no fixed transmitter; add a [[transmitter]] with role = "
                          "\"fixed\" and its position to site.toml");
  }
  auto room = load_room_model(site_);
  if (!room) {
    return tl::make_unexpected(std::move(room.error()));
  }
  room_ = *std::move(room);
  if (!options_.quiet) {
    print_scene_notes(*room_.scene);
  }
  auto empty = read_captures(options_.captures);
  if (!empty) {
    return tl::make_unexpected(std::move(empty.error()));
  }
  empty_ = *std::move(empty);
  if (!options_.people_empty.empty()) {
    auto people_empty = read_captures(options_.people_empty);
    if (!people_empty) {
      return tl::make_unexpected(std::move(people_empty.error()));
    }
    people_empty_ = *std::move(people_empty);
  }
  if (options_.people.empty()) {
    return {};
  }
  auto people = read_captures(options_.people);
  if (!people) {
    return tl::make_unexpected(std::move(people.error()));
  }
  people_ = *std::move(people);
  auto points = load_points_csv(options_.points, options_.time_offset);
  if (!points) {
    return tl::make_unexpected(std::move(points.error()));
  }
  points_ = *std::move(points);
  return {};
}

Transmitter surveyed_place(const SiteTransmitter& transmitter) {
  return {{*transmitter.position, {}, transmitter.pattern, transmitter.polarization}};
}

Expected<std::vector<EmptyRoom>> Reference::empty_rooms_of(const std::vector<CsiFrame>& frames,
                                                           bool occupied) {
  BurstOptions burst_options;
  burst_options.max_frames = kMaxEmptyFrames;
  std::vector<EmptyRoom> received;
  for (std::size_t a = 0; a < room_.access_points.size(); ++a) {
    const RoomAccessPoint& ap = room_.access_points[a];
    const bool recorded = std::any_of(frames.begin(), frames.end(), [&](const CsiFrame& frame) {
      return frame.access_point == static_cast<int>(a);
    });
    if (!recorded) {
      refused_.push_back({ap.id, "not in the recordings: it will not look for people"});
      continue;
    }
    if (const std::string problem = calibration_problem(room_, ap); !problem.empty()) {
      return make_error(ErrorKind::kConfiguration, "access point " + ap.id + " " + problem);
    }
    std::vector<std::string> warnings;
    auto burst = occupied ? receive_background(room_, a, frames, burst_options, warnings)
                          : preprocess_burst(room_, a, frames, burst_options, warnings);
    if (!burst) {
      return bad_input(warnings.front());
    }
    if (!occupied && burst->motion_residual > kMaxChange) {
      return bad_input("access point " + ap.id + ": the channel of " +
                       to_string(frames.front().transmitter) +
                       " changes during the recording of the empty room; record it again with no "
                       "person inside and nothing moving, or give --occupied");
    }
    for (const auto& value : burst->h) {
      content_.add(value.real());
      content_.add(value.imag());
    }
    received.push_back({a, std::move(burst->h)});
  }
  return received;
}

Expected<void> Reference::add_reference(const MacAddress& mac,
                                        const Transmitter& surveyed,
                                        const std::vector<EmptyRoom>& received) {
  auto reference = fit_empty_room(people_room_, surveyed, received);
  if (!reference) {
    return tl::make_unexpected(std::move(reference.error()));
  }
  reference->mac = mac;
  reference->person = stated_person(site_);
  reference->area = stated_area(site_);
  references_.push_back(*std::move(reference));
  return {};
}

Expected<void> Reference::learn_empty_room() {
  content_.add(room_.calibration_id);
  people_room_ = room_;
  if (!options_.people_empty.empty()) {
    return learn_two_days();
  }
  for (const auto& [mac, frames] : empty_) {
    const auto received = empty_rooms_of(frames, options_.occupied);
    if (!received) {
      return tl::make_unexpected(received.error());
    }
    const Transmitter surveyed = surveyed_place(*find_transmitter(site_, mac));
    if (auto added = add_reference(mac, surveyed, *received); !added) {
      return added;
    }
  }
  return {};
}

// The references are those of the day of the people until all values are learned.
Expected<void> Reference::learn_two_days() {
  std::vector<MacAddress> macs;
  for (const auto& [mac, frames] : empty_) {
    const auto before = people_empty_.find(mac);
    if (before == people_empty_.end()) {
      refused_.push_back({to_string(mac), "not in the recordings of --people-empty"});
      continue;
    }
    auto today = empty_rooms_of(frames, options_.occupied);
    if (!today) {
      return tl::make_unexpected(std::move(today.error()));
    }
    auto people = empty_rooms_of(before->second, false);
    if (!people) {
      return bad_input("--people-empty: " + people.error().message);
    }
    macs.push_back(mac);
    received_.push_back(
        {surveyed_place(*find_transmitter(site_, mac)), *std::move(people), *std::move(today)});
  }
  auto days = separate_days(room_, received_);
  if (!days) {
    return tl::make_unexpected(std::move(days.error()));
  }
  room_ = std::move(days->today);
  people_room_ = std::move(days->people);
  changes_ = std::move(days->changes);
  received_.clear();
  for (std::size_t i = 0; i < macs.size(); ++i) {
    ReceivedDays& received = days->received[i];
    if (received.today.empty()) {
      refused_.push_back({to_string(macs[i]), "no access point received it on both days"});
      continue;
    }
    if (auto added = add_reference(macs[i], received.surveyed, received.people); !added) {
      return added;
    }
    received_.push_back(std::move(received));
  }
  return {};
}

std::vector<PersonSpot> Reference::spots_of(const PersonReference& reference,
                                            const std::vector<CsiFrame>& frames,
                                            std::vector<std::vector<CsiFrame>>& frames_of_spot) {
  std::vector<PersonSpot> spots;
  for (const SurveyPoint& point : points_) {
    std::vector<CsiFrame> own;
    std::copy_if(frames.begin(), frames.end(), std::back_inserter(own), [&](const CsiFrame& f) {
      return f.time >= point.t_start - kReferenceClockSlack &&
             f.time <= point.t_end + kReferenceClockSlack;
    });
    PersonSpot spot{{point.position.x, point.position.y}, {}};
    std::vector<std::string> warnings;
    for (const PersonLink& link : reference.links) {
      auto burst = preprocess_burst(people_room_, link.access_point, own, {}, warnings);
      spot.h.push_back(burst ? std::move(burst->h) : std::vector<std::complex<double>>());
      for (const auto& value : spot.h.back()) {
        content_.add(value.real());
        content_.add(value.imag());
      }
    }
    content_.add(spot.place.x);
    content_.add(spot.place.y);
    const std::string what = options_.points + ":" + std::to_string(point.line);
    for (const std::string& warning : warnings) {
      refused_.push_back({what, warning});
    }
    if (own.empty()) {
      refused_.push_back({what, "no frames of " + to_string(reference.mac) + " at that time"});
      continue;
    }
    spots.push_back(std::move(spot));
    frames_of_spot.push_back(std::move(own));
  }
  return spots;
}

// One person model serves all transmitters: fitted with the first that has data of people.
Expected<void> Reference::learn_person() {
  for (PersonReference& reference : references_) {
    const auto frames = people_.find(reference.mac);
    if (frames == people_.end()) {
      refused_.push_back({to_string(reference.mac), "not in the recordings of people"});
      continue;
    }
    std::vector<std::vector<CsiFrame>> frames_of_spot;
    const auto spots = spots_of(reference, frames->second, frames_of_spot);
    if (const auto trace = DeviceTrace::of(frames->second); spots.empty()) {
      return bad_input("--people: received " + to_string(reference.mac) + " " +
                       explain_other_times(options_.points, points_, trace));
    }
    auto fit = fit_person(people_room_, reference, spots);
    if (!fit) {
      return bad_input(options_.points + ": " + fit.error().message);
    }
    const auto certainty = fit_person_certainty(people_room_, *fit, spots, frames_of_spot);
    if (!certainty) {
      return tl::make_unexpected(certainty.error());
    }
    reference = std::move(fit->reference);
    reference.person.likelihood_exponent = certainty->likelihood_exponent;
    reference.person.second_person = certainty->second_person;
    spots_ = std::max(spots_, fit->spots);
  }
  return {};
}

// The calibration unchanged, or with the new gains of chains whose phases have changed since.
Expected<std::string> Reference::calibration_text() {
  const bool is_turned = std::any_of(changes_.begin(), changes_.end(), [](const DayChange& one) {
    return one.is_turned && one.is_today_turned;
  });
  if (!is_turned) {
    return read_file(*site_.calibration_file);
  }
  auto calibration = load_calibration_file(*site_.calibration_file);
  if (!calibration) {
    return tl::make_unexpected(std::move(calibration.error()));
  }
  for (const DayChange& change : changes_) {
    const RoomAccessPoint& ap = room_.access_points[change.access_point];
    for (CalibratedAccessPoint& stated : calibration->access_points) {
      if (stated.id == ap.id && change.is_turned && change.is_today_turned) {
        stated.gains = ap.gains;
        for (std::size_t m = 0; m < stated.gain_sigma.size(); ++m) {
          stated.gain_sigma[m] = std::hypot(stated.gain_sigma[m], change.chains.sigma[m]);
        }
      }
    }
  }
  calibration->id = content_.text();
  room_.calibration_id = calibration->id;
  return to_toml(*calibration);
}

Expected<void> Reference::write() {
  for (PersonReference& reference : references_) {
    reference.id = content_.text();
  }
  const fs::path out = options_.out;
  if (auto prepared = prepare_output(out, options_.force); !prepared) {
    return prepared;
  }
  const auto calibration = calibration_text();
  if (!calibration) {
    return tl::make_unexpected(calibration.error());
  }
  const fs::path file = out / "reference.toml";
  if (auto written = write_file(file, reference_toml(references_, room_, spots_)); !written) {
    return written;
  }
  Site site = site_;
  site.reference_file = file;
  if (auto written = write_site(site, *calibration, out); !written) {
    return written;
  }
  for (const char* name : {"report.json", "report.html"}) {  // reports of the calibration
    if (const auto report = read_file(site_.calibration_file->parent_path() / name)) {
      if (auto written = write_file(out / name, *report); !written) {
        return written;
      }
    }
  }
  return {};
}

Expected<void> Reference::run() {
  if (options_.people.empty() != options_.points.empty()) {
    return make_error(ErrorKind::kUsage,
                      "--people and --points belong together: recordings of people at known "
                      "places, and a csv t_start,t_end,x,y,z of the places");
  }
  if (options_.people.empty() && !options_.people_empty.empty()) {
    return make_error(ErrorKind::kUsage,
                      "--people-empty is the empty room of the day of --people; give these, too");
  }
  if (auto done = read(); !done) {
    return done;
  }
  if (auto done = learn_empty_room(); !done) {
    return done;
  }
  if (!options_.people.empty()) {
    if (auto done = learn_person(); !done) {
      return done;
    }
  }
  for (std::size_t i = 0; i < received_.size(); ++i) {
    references_[i] = moved_to_today(room_.grid, std::move(references_[i]), received_[i].today);
  }
  if (auto done = write(); !done) {
    return done;
  }
  if (!options_.quiet) {
    print_reference({site_, room_, changes_, references_, spots_, notes_, refused_});
  }
  return {};
}

RunVerb declare_reference(OptionParser& app) {
  const auto options = std::make_shared<ReferenceOptions>();
  app.add_option("site", options->site, "calibrated site: directory with site.toml")->required();
  app.add_option("--capture",
                 options->captures,
                 "recordings of the empty room: [AP=]FILE, with a fixed transmitter")
      ->required();
  app.add_option("--people", options->people, "recordings of a person at known places: [AP=]FILE");
  app.add_option("--people-empty",
                 options->people_empty,
                 "recordings of the empty room of the day of --people, where that is another day: "
                 "[AP=]FILE; chains may have turned since, and chairs moved");
  app.add_option("--points", options->points, "where and when: csv t_start,t_end,x,y,z");
  app.add_option("--time-offset", options->time_offset, kTimeOffsetHelp);
  app.add_option("--out", options->out, "folder to create: the site with its reference")
      ->required();
  app.add_flag("--occupied",
               options->occupied,
               "a person walks about in the recordings of the empty room: the channel common to "
               "half of the frames is that of the room");
  app.add_flag("--force", options->force, "write into a folder that is not empty");
  app.add_flag("--quiet", options->quiet, "no words on stderr");
  return [options] { return Reference(*options).run(); };
}

}  // namespace

extern const Verb kReference;
const Verb kReference = {
    "reference",
    "Learn the empty room, so that people without a device can be located",
    "rayloc reference office-calibrated --capture ap1=empty.pcap --out office-people\n"
    "  rayloc reference office-calibrated --capture ap1=empty.pcap0 ap1=empty.pcap1 --out "
    "office-people\n"
    "  rayloc reference office-calibrated --capture ap1=empty.pcap --people ap1=person.pcap "
    "--points places.csv --out office-people\n"
    "  rayloc reference office-calibrated --capture ap1=today.pcap --people ap1=person.pcap "
    "--people-empty ap1=empty.pcap --points places.csv --out office-today\n"
    "  rayloc reference office-calibrated --capture ap1=monday.pcap --occupied --out office-people",
    declare_reference};

}  // namespace rayloc::cli
