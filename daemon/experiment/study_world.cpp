#include "daemon/experiment/study_world.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <iterator>
#include <optional>
#include <random>
#include <string>
#include <utility>

#include "capture/assemble/csi_receiver.h"
#include "daemon/experiment/study_room.h"
#include "daemon/scene/room_plan.h"
#include "daemon/simulate/capture_simulator.h"
#include "daemon/simulate/handling.h"
#include "daemon/simulate/impairments.h"
#include "daemon/simulate/random_stream.h"
#include "daemon/simulate/second_day.h"
#include "daemon/simulate/solid_objects.h"
#include "engine/scene/scene.h"

namespace rayloc {
namespace {

constexpr Duration kSpotInterval = std::chrono::seconds(1);
constexpr Duration kFrameInterval = std::chrono::milliseconds(10);
constexpr double kClearOfWalls = 0.3;         // [m]
constexpr double kClearOfBoxes = 0.05;        // [m]
constexpr double kDistanceTolerance = 0.25;   // [m]
constexpr double kClearOfDevices = 0.2;       // [m], of people
constexpr double kClearOfAccessPoints = 1.0;  // [m], of fixed transmitters
constexpr std::size_t kEmptyFrames = 20;
constexpr double kPersonHeight = 1.7;  // [m]

struct Place {
  const RoomPlan& plan;
  const Scene& scene;
  const Condition& condition;
  std::optional<Vec3d> transmitter;     // of people
  const SolidObjects* moved = nullptr;  // objects where they are on a second day

  bool is_clear(const Vec3d& spot) const {
    if (moved != nullptr && moved->contain(spot)) {
      return false;
    }
    if (condition.kind != "person") {
      return !is_in_box(plan, spot, kClearOfBoxes);
    }
    // A person is as high as furniture, and stands in nothing.
    const double clear = condition.person_radius_m + kClearOfBoxes;
    const bool in_box = std::any_of(plan.boxes.begin(), plan.boxes.end(), [&](const PlanBox& box) {
      RoomPlan one;
      one.boxes = {box};
      return is_in_box(one, {spot.x, spot.y, box.centre.z}, clear);
    });
    const auto is_close = [&](const Vec3d& device) {
      return std::hypot(spot.x - device.x, spot.y - device.y) < clear + kClearOfDevices;
    };
    return !in_box && !(transmitter && is_close(*transmitter)) &&
           std::none_of(plan.access_points.begin(), plan.access_points.end(), [&](const auto& ap) {
             return is_close(ap.array.pose.position);
           });
  }

  bool suits(const Vec3d& spot) const {
    const Vec3d& ap = plan.access_points.front().array.pose.position;
    const double distance = std::hypot(spot.x - ap.x, spot.y - ap.y);
    if (condition.distance_m > 0.0 &&
        std::abs(distance - condition.distance_m) > kDistanceTolerance) {
      return false;
    }
    const bool is_blocked = scene.is_blocked({ap, spot});
    return is_clear(spot) &&
           (condition.sight == "any" || is_blocked == (condition.sight == "nlos"));
  }
};

// A place anywhere in the room, at the height of devices.
class AnyPlace {
 public:
  explicit AnyPlace(const Place& place)
      : along_x_(place.plan.lower.x + margin(place), place.plan.upper.x - margin(place)),
        along_y_(place.plan.lower.y + margin(place), place.plan.upper.y - margin(place)),
        height_(place.condition.device_height_m) {}

  Vec3d draw(RandomStream& random) {
    const double x = along_x_(random);
    const double y = along_y_(random);
    return {x, y, height_};
  }

 private:
  static double margin(const Place& place) {
    const Vec3d size = place.plan.upper - place.plan.lower;
    return std::min({kClearOfWalls, 0.25 * size.x, 0.25 * size.y});
  }

  std::uniform_real_distribution<double> along_x_;
  std::uniform_real_distribution<double> along_y_;
  double height_;
};

// Heights of devices have a stream of their own: with another deviation they are held elsewhere at
// the same places.
class Heights {
 public:
  Heights(const Place& place, std::uint64_t seed, std::size_t layout)
      : sigma_(place.condition.height_sigma_m),
        lower_(place.plan.lower.z + kHeightMargin),
        upper_(place.plan.upper.z - kHeightMargin),
        random_(random_stream(seed, "heights", layout)) {}

  // Raises or lowers the place; not out of the room.
  void change(Vec3d& place) {
    if (sigma_ <= 0.0) {
      return;
    }
    constexpr int kAttempts = 1000;
    double height = place.z + sigma_ * normal_(random_);
    for (int n = 0; n < kAttempts && (height < lower_ || height > upper_); ++n) {
      height = place.z + sigma_ * normal_(random_);
    }
    place.z = std::clamp(height, lower_, upper_);
  }

 private:
  double sigma_;
  double lower_;
  double upper_;
  RandomStream random_;
  std::normal_distribution<double> normal_;
};

// Where a fixed transmitter of people stands: clear of boxes and not beside an access point.
Expected<Vec3d> draw_transmitter(const Place& place, std::uint64_t seed, std::size_t layout) {
  RandomStream random = random_stream(seed, "transmitter", layout);
  AnyPlace any(place);
  constexpr int kAttempts = 20'000;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const Vec3d at = any.draw(random);
    const bool beside = std::any_of(
        place.plan.access_points.begin(), place.plan.access_points.end(), [&](const auto& ap) {
          const Vec3d& device = ap.array.pose.position;
          return std::hypot(at.x - device.x, at.y - device.y) < kClearOfAccessPoints;
        });
    if (!beside && !is_in_box(place.plan, at, kClearOfBoxes)) {
      return at;
    }
  }
  return make_error(ErrorKind::kConfiguration,
                    place.condition.room.string() +
                        ": no place for a fixed transmitter 1 m from every access point");
}

Expected<std::vector<Vec3d>> draw_spots(const Place& place,
                                        std::uint64_t seed,
                                        std::size_t layout) {
  const RoomPlan& plan = place.plan;
  const Condition& condition = place.condition;
  RandomStream random = random_stream(seed, "spots", layout);
  AnyPlace any(place);
  Heights heights(place, seed, layout);
  const auto count = static_cast<std::size_t>(condition.spots);
  constexpr std::size_t kAttempts = 20'000;  // of each spot
  std::vector<Vec3d> spots;
  for (std::size_t attempt = 0; spots.size() < count; ++attempt) {
    if (attempt == count * kAttempts) {
      return make_error(
          ErrorKind::kConfiguration,
          condition.room.string() + ": the room has hardly a place with sight \"" +
              condition.sight + "\" of access point '" + plan.access_points.front().id + "'" +
              (condition.distance_m > 0.0 ? " at " + condition_text(condition, "distance_m") + " m"
                                          : "") +
              ": " + std::to_string(spots.size()) + " of " + std::to_string(count) +
              " were found; change 'sight', 'distance_m' or the plan");
    }
    Vec3d spot = any.draw(random);
    heights.change(spot);
    if (place.suits(spot)) {
      spots.push_back(spot);
    }
  }
  return spots;
}

// Where the survey stood: anywhere in the room that is clear, whatever is asked of the spots.
std::vector<Vec3d> draw_survey(const Place& place, std::uint64_t seed, std::size_t layout) {
  RandomStream random = random_stream(seed, "survey", layout);
  AnyPlace any(place);
  const auto count = static_cast<std::size_t>(place.condition.survey_points);
  constexpr std::size_t kAttempts = 1000;  // of each point
  std::vector<Vec3d> points;
  for (std::size_t attempt = 0; points.size() < count && attempt < count * kAttempts; ++attempt) {
    const Vec3d at = any.draw(random);
    if (place.is_clear(at)) {
      points.push_back(at);
    }
  }
  return points;
}

SimulatedSpot transmissions(const Vec3d& position,
                            std::size_t number,
                            std::size_t frames,
                            RandomStream& traffic) {
  SimulatedSpot spot;
  spot.position = position;
  const Timestamp begin =
      Timestamp(std::chrono::hours(1)) + static_cast<Duration::rep>(number) * kSpotInterval;
  for (Duration::rep n = 0; n < static_cast<Duration::rep>(frames); ++n) {
    constexpr std::uint16_t kFirstFragment = 16;  // numbers count from bit 4
    const auto control = static_cast<std::uint16_t>((n + 1) * kFirstFragment);
    spot.frames.push_back({begin + n * kFrameInterval, control, traffic()});
  }
  return spot;
}

// Before each chain was multiplied by its change, if any was.
ChainGains before(ChainGains gains, const std::vector<std::complex<double>>& changes) {
  const std::size_t tones = gains.grid.size();
  for (std::size_t i = 0; i < changes.size() * tones; ++i) {
    gains.gain[i] /= changes[i / tones];
  }
  return gains;
}

// The gains on the tones that the model knows.
ChainGains on_grid(const ChainGains& all, const OfdmGrid& grid) {
  ChainGains gains{grid, all.cores, {}, all.coupling};
  for (std::size_t core = 0; core < all.cores.size(); ++core) {
    for (const std::int16_t tone : grid.tone_index) {
      const auto found =
          std::lower_bound(all.grid.tone_index.begin(), all.grid.tone_index.end(), tone);
      gains.gain.push_back(all.gain[core * all.grid.size() +
                                    static_cast<std::size_t>(found - all.grid.tone_index.begin())]);
    }
  }
  return gains;
}

std::vector<CsiFrame> decode(const SpotCapture& capture, const RoomAccessPoint& ap, int index) {
  CsiReceiverOptions options;
  options.access_point = index;
  options.expected_cores = ap.cores;
  CsiReceiver receiver(options);
  std::vector<CsiFrame> frames;
  for (const SimulatedDatagram& datagram : capture.datagrams) {
    receiver.push({datagram.time, {}, datagram.payload}, frames);
  }
  receiver.flush(frames);
  return frames;
}

void sort_by_time(std::vector<CsiFrame>& frames) {
  std::stable_sort(frames.begin(), frames.end(), [](const CsiFrame& a, const CsiFrame& b) {
    return a.time < b.time;
  });
}

// What is simulated, all of it drawn.
struct Transmissions {
  LivedInRoom truth;
  SimulatedSpot empty;               // of people
  std::vector<SimulatedSpot> spots;  // of the layout
  std::vector<SimulatedSpot> survey;
};

void append(std::vector<CsiFrame> more, std::vector<CsiFrame>& frames) {
  std::move(more.begin(), more.end(), std::back_inserter(frames));
}

Expected<void> hear(const Transmissions& sent, CaptureOptions options, StudyLayout& layout) {
  const RoomModel& truth = sent.truth.room;
  for (std::size_t ap = 0; ap < truth.access_points.size(); ++ap) {
    const auto listen = [&](CaptureSimulator& simulator,
                            const SimulatedSpot& spot,
                            std::vector<CsiFrame>& frames) -> Expected<void> {
      auto heard = simulator.hear(spot);
      if (!heard) {
        return tl::make_unexpected(std::move(heard.error()));
      }
      append(decode(*heard, truth.access_points[ap], static_cast<int>(ap)), frames);
      return {};
    };
    options.chain_changes = sent.truth.access_points[ap].chain_changes;
    CaptureSimulator simulator(truth, ap, options);
    ChainGains& chains = layout.model.access_points[ap].gains;
    chains = on_grid(simulator.chains(), layout.model.grid);
    layout.first_day_chains.push_back(before(chains, options.chain_changes));
    if (options.person) {
      CaptureOptions alone = options;
      alone.person.reset();
      CaptureSimulator empty(truth, ap, alone);  // the same radio: it has the same seed
      if (auto heard = listen(empty, sent.empty, layout.empty); !heard) {
        return heard;
      }
    }
    for (std::size_t i = 0; i < sent.spots.size(); ++i) {
      if (auto heard = listen(simulator, sent.spots[i], layout.spots[i].frames); !heard) {
        return heard;
      }
    }
    // Last: without a survey all else is the same.
    for (std::size_t i = 0; i < sent.survey.size(); ++i) {
      if (auto heard = listen(simulator, sent.survey[i], layout.survey[i].frames); !heard) {
        return heard;
      }
    }
  }
  sort_by_time(layout.empty);
  for (std::vector<StudySpot>* spots : {&layout.spots, &layout.survey}) {
    for (StudySpot& spot : *spots) {
      sort_by_time(spot.frames);
    }
  }
  return {};
}

Expected<Impairments> impairments_of(const Condition& condition) {
  if (condition.impairments == "default") {
    return default_impairments();
  }
  return condition.impairments == "none"
             ? no_impairments()
             : load_impairments(condition.room.parent_path() / condition.impairments);
}

Expected<SecondDay> day_of(const Condition& condition) {
  if (condition.second_day == "none") {
    return unchanged_day();
  }
  return condition.second_day == "default"
             ? default_second_day()
             : load_second_day(condition.room.parent_path() / condition.second_day);
}

// The room as it is when the spots are visited.
Expected<LivedInRoom> make_truth(const RoomPlan& plan,
                                 const Condition& condition,
                                 std::uint64_t seed) {
  const auto day = day_of(condition);
  if (!day) {
    return tl::make_unexpected(day.error());
  }
  const auto room = make_room(plan, condition);
  return room ? live_in(*room, *day, seed) : tl::make_unexpected(room.error());
}

// Where somebody is, and what is sent meanwhile.
Expected<void> draw_transmissions(const Place& place,
                                  std::uint64_t seed,
                                  std::size_t number,
                                  Transmissions& sent) {
  const auto places = draw_spots(place, seed, number);
  if (!places) {
    return tl::make_unexpected(places.error());
  }
  RandomStream traffic = random_stream(seed, "traffic", number);
  if (place.transmitter) {
    sent.empty = transmissions(*place.transmitter, 0, kEmptyFrames, traffic);
  }
  for (const Vec3d& at : *places) {
    const std::size_t after = sent.spots.size() + (place.transmitter ? 1U : 0U);
    const auto frames = static_cast<std::size_t>(place.condition.frames);
    sent.spots.push_back(transmissions(at, after, frames, traffic));
  }
  RandomStream survey_traffic = random_stream(seed, "survey traffic", number);
  for (const Vec3d& at : draw_survey(place, seed, number)) {
    const std::size_t after =
        sent.spots.size() + sent.survey.size() + (place.transmitter ? 1U : 0U);
    const auto frames = static_cast<std::size_t>(place.condition.frames);
    sent.survey.push_back(transmissions(at, after, frames, survey_traffic));
  }
  const Handling handling{0.0, place.condition.tilt_deg, place.condition.power_sigma_db};
  return handle_devices(sent.spots,
                        false,
                        handling,
                        sent.truth.room,
                        random_stream(seed, "handling", number)(),
                        place.condition.room.string());
}

CaptureOptions capture_options(const Condition& condition,
                               const RoomPlan& plan,
                               const StudyLayout& layout) {
  CaptureOptions options;
  options.transmitter = kStudyTransmitter;
  options.pattern = layout.model.device.pattern;
  options.polarization = layout.model.device.polarization;
  options.bandwidth_mhz = plan.carrier.bandwidth_mhz;
  options.trace.max_depth = static_cast<int>(condition.depth);
  if (layout.transmitter) {
    SimulatedPerson person{layout.transmitter->position, {}};
    person.body.semi_axes = {condition.person_radius_m, condition.person_radius_m};
    person.body.height = kPersonHeight;
    options.person = person;
  }
  return options;
}

Expected<StudyLayout> simulate_layout(const RoomPlan& original,
                                      const Condition& condition,
                                      std::uint64_t seed,
                                      std::size_t number) {
  const auto impairments = impairments_of(condition);
  if (!impairments) {
    return tl::make_unexpected(impairments.error());
  }
  const auto plan = furnish(original, condition, seed, number);
  if (!plan) {
    return tl::make_unexpected(plan.error());
  }
  auto model = make_room(*plan, condition);
  const std::uint64_t radios = random_stream(seed, "radios", number)();
  auto truth = make_truth(misplace(*plan, condition, seed, number), condition, radios);
  if (!model || !truth) {
    return tl::make_unexpected(model ? truth.error() : model.error());
  }
  StudyLayout layout{*std::move(model), {}, {}, {}, std::nullopt, {}};
  Transmissions sent{*std::move(truth), {}, {}, {}};
  const SolidObjects objects(sent.truth.room);
  Place place{*plan, *sent.truth.room.scene, condition, std::nullopt};
  place.moved = sent.truth.moved.empty() ? nullptr : &objects;
  if (condition.kind == "person") {
    const auto at = draw_transmitter(place, seed, number);
    if (!at) {
      return tl::make_unexpected(at.error());
    }
    place.transmitter = *at;
    const DeviceModel& device = layout.model.device;
    layout.transmitter = Transmitter{{*at, {}, device.pattern, device.polarization}};
  }
  if (auto drawn = draw_transmissions(place, seed, number, sent); !drawn) {
    return tl::make_unexpected(std::move(drawn.error()));
  }
  for (const SimulatedSpot& spot : sent.spots) {
    layout.spots.push_back({spot.position, {}});
  }
  for (const SimulatedSpot& point : sent.survey) {
    layout.survey.push_back({point.position, {}});
  }
  CaptureOptions options = capture_options(condition, *plan, layout);
  options.impairments = *impairments;
  options.seed = radios;
  if (auto heard = hear(sent, options, layout); !heard) {
    return tl::make_unexpected(std::move(heard.error()));
  }
  return layout;
}

}  // namespace

Expected<std::vector<StudyLayout>> simulate_world(const Condition& condition, std::uint64_t seed) {
  const auto plan = load_room_plan(condition.room);
  if (!plan) {
    return tl::make_unexpected(plan.error());
  }
  if (!plan->rooms.empty()) {
    return make_error(ErrorKind::kConfiguration,
                      condition.room.string() +
                          ": studies move the walls of a room of four; write 'size', no outline");
  }
  std::vector<StudyLayout> layouts;
  for (std::size_t i = 0; i < static_cast<std::size_t>(condition.layouts); ++i) {
    auto layout = simulate_layout(*plan, condition, seed, i);
    if (!layout) {
      return tl::make_unexpected(std::move(layout.error()));
    }
    layouts.push_back(*std::move(layout));
  }
  return layouts;
}

}  // namespace rayloc
