#include "daemon/lab/experiment/study_world.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <iterator>
#include <optional>
#include <random>
#include <string>
#include <utility>

#include "daemon/lab/experiment/study_places.h"
#include "daemon/lab/experiment/study_radio.h"
#include "daemon/lab/experiment/study_room.h"
#include "daemon/lab/experiment/study_walk.h"
#include "daemon/lab/simulate/capture_simulator.h"
#include "daemon/lab/simulate/handling.h"
#include "daemon/lab/simulate/impairments.h"
#include "daemon/lab/simulate/random_stream.h"
#include "daemon/lab/simulate/second_day.h"
#include "daemon/lab/simulate/solid_objects.h"
#include "daemon/site/scene/room_plan.h"
#include "engine/scene/scene.h"

namespace rayloc {
namespace {

constexpr Duration kPointInterval = std::chrono::seconds(1);
constexpr Duration kFrameInterval = std::chrono::milliseconds(10);
constexpr std::size_t kEmptyFrames = 20;
constexpr double kPersonHeight = 1.7;  // [m]

// The n-th frame of a test point.
Transmission transmission(std::size_t test_point,
                          std::size_t n,
                          Duration interval,
                          std::size_t channels,
                          RandomStream& traffic) {
  constexpr std::uint16_t kFirstFragment = 16;  // sequence numbers start at bit 4
  const Timestamp begin =
      Timestamp(std::chrono::hours(1)) + static_cast<Duration::rep>(test_point) * kPointInterval;
  return {begin + static_cast<Duration::rep>(n) * interval,
          static_cast<std::uint16_t>((n + 1) * kFirstFragment),
          traffic(),
          n % channels};
}

SimulatedPoint transmissions(const Vec3d& position,
                             std::size_t number,
                             std::size_t frames,
                             std::size_t channels,
                             RandomStream& traffic) {
  SimulatedPoint test_point;
  test_point.position = position;
  for (std::size_t n = 0; n < frames; ++n) {
    test_point.frames.push_back(transmission(number, n, kFrameInterval, channels, traffic));
  }
  return test_point;
}

void sort_by_time(std::vector<CsiFrame>& frames) {
  std::stable_sort(frames.begin(), frames.end(), [](const CsiFrame& a, const CsiFrame& b) {
    return a.time < b.time;
  });
}

// Everything that is simulated, with all random draws made.
struct Transmissions {
  LivedInRoom truth;
  std::vector<RoomModel> rooms;                    // the same on each hop channel of devices
  SimulatedPoint empty;                            // for people
  std::vector<SimulatedPoint> test_points;         // in the layout
  std::vector<std::vector<SimulatedPoint>> walks;  // in the layout; a test point is a frame
  std::vector<SimulatedPoint> survey;
};

void append(std::vector<CsiFrame> more, std::vector<CsiFrame>& frames) {
  std::move(more.begin(), more.end(), std::back_inserter(frames));
}

Expected<void> receive(const Transmissions& sent, CaptureOptions options, StudyLayout& layout) {
  const RoomModel& truth = sent.truth.room;
  for (std::size_t ap = 0; ap < truth.access_points.size(); ++ap) {
    const auto listen = [&](CaptureSimulator& simulator,
                            const SimulatedPoint& test_point,
                            std::vector<CsiFrame>& frames) -> Expected<void> {
      auto received = simulator.capture(test_point);
      RAYLOC_TRY(received);
      append(decoded_frames(*received, truth.access_points[ap], ap), frames);
      return {};
    };
    options.chain_changes = sent.truth.access_points[ap].chain_changes;
    CaptureSimulator simulator(sent.rooms, ap, options);
    ChainGains& chains = layout.model.access_points[ap].gains;
    chains = gains_on_grid(simulator.chains(nearest_channel(sent.rooms, layout.model)),
                           layout.model.grid);
    layout.first_day_chains.push_back(before_changes(chains, options.chain_changes));
    if (options.person) {
      CaptureOptions alone = options;
      alone.person.reset();
      CaptureSimulator empty(sent.rooms, ap, alone);  // the same radio: it has the same seed
      RAYLOC_TRY(listen(empty, sent.empty, layout.empty));
    }
    for (std::size_t i = 0; i < sent.test_points.size(); ++i) {
      RAYLOC_TRY(listen(simulator, sent.test_points[i], layout.test_points[i].frames));
    }
    for (std::size_t i = 0; i < sent.walks.size(); ++i) {
      for (const SimulatedPoint& frame : sent.walks[i]) {
        RAYLOC_TRY(listen(simulator, frame, layout.walks[i].frames));
      }
    }
    // Drawn last: without a survey all other draws are unchanged.
    for (std::size_t i = 0; i < sent.survey.size(); ++i) {
      RAYLOC_TRY(listen(simulator, sent.survey[i], layout.survey[i].frames));
    }
  }
  sort_by_time(layout.empty);
  for (std::vector<StudyPoint>* test_points : {&layout.test_points, &layout.survey}) {
    for (StudyPoint& test_point : *test_points) {
      sort_by_time(test_point.frames);
    }
  }
  for (StudyWalk& walk : layout.walks) {
    sort_by_time(walk.frames);
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

// The room at the time when the test points are visited.
Expected<LivedInRoom> make_truth(const RoomPlan& plan,
                                 const Condition& condition,
                                 std::uint64_t seed) {
  const auto day = day_of(condition);
  RAYLOC_TRY(day);
  const auto room = make_room(plan, condition);
  return room ? live_in(*room, *day, seed) : tl::make_unexpected(room.error());
}

// The same room on each channel.
Expected<void> make_rooms(const RoomPlan& plan,
                          const Condition& condition,
                          std::uint64_t seed,
                          Transmissions& sent) {
  const auto plans = on_channels(plan, condition);
  RAYLOC_TRY(plans);
  for (const RoomPlan& on_channel : *plans) {
    auto truth = make_truth(on_channel, condition, seed);
    RAYLOC_TRY(truth);
    sent.truth = *std::move(truth);
    sent.rooms.push_back(sent.truth.room);
  }
  return {};
}

Expected<void> add_test_points(const StudyPlaces& places,
                               std::uint64_t seed,
                               std::size_t layout,
                               RandomStream& traffic,
                               std::size_t& after,
                               Transmissions& sent) {
  const auto test_points = draw_test_points(places, seed, layout);
  RAYLOC_TRY(test_points);
  const auto frames = static_cast<std::size_t>(places.condition.frames);
  for (const Vec3d& at : *test_points) {
    sent.test_points.push_back(transmissions(at, after++, frames, sent.rooms.size(), traffic));
  }
  return {};
}

// Adds a frame at each place of a walk.
Expected<void> add_walks(const StudyPlaces& places,
                         std::uint64_t seed,
                         std::size_t layout,
                         RandomStream& traffic,
                         std::size_t& after,
                         Transmissions& sent) {
  const auto walks = draw_walks(places, seed, layout);
  RAYLOC_TRY(walks);
  const Duration interval(std::llround(1e9 / places.condition.rate_hz));
  for (const std::vector<Vec3d>& walk : *walks) {
    std::vector<SimulatedPoint>& frames = sent.walks.emplace_back();
    for (std::size_t n = 0; n < walk.size(); ++n) {
      SimulatedPoint& frame = frames.emplace_back();
      frame.position = walk[n];
      frame.frames.push_back(transmission(after, n, interval, sent.rooms.size(), traffic));
    }
    after += 1U + static_cast<std::size_t>(std::ceil(places.condition.walk_s));
  }
  return {};
}

// Draws the positions of a device or person, and the transmissions meanwhile.
Expected<void> draw_transmissions(const StudyPlaces& places,
                                  std::uint64_t seed,
                                  std::size_t number,
                                  Transmissions& sent) {
  const auto frames = static_cast<std::size_t>(places.condition.frames);
  RandomStream traffic = random_stream(seed, "traffic", number);
  std::size_t after = 0;  // number of preceding test points
  if (places.transmitter) {
    sent.empty =
        transmissions(*places.transmitter, after++, kEmptyFrames, sent.rooms.size(), traffic);
  }
  auto drawn = is_walking(places.condition)
                   ? add_walks(places, seed, number, traffic, after, sent)
                   : add_test_points(places, seed, number, traffic, after, sent);
  if (!drawn) {
    return drawn;
  }
  RandomStream survey_traffic = random_stream(seed, "survey traffic", number);
  for (const Vec3d& at : draw_survey(places, seed, number)) {
    sent.survey.push_back(transmissions(at, after++, frames, sent.rooms.size(), survey_traffic));
  }
  const Handling handling{0.0, places.condition.tilt_deg, places.condition.power_sigma_db};
  return handle_devices(sent.test_points,
                        false,
                        handling,
                        sent.truth.room,
                        random_stream(seed, "handling", number)(),
                        places.condition.room.string());
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

// An instant each 0.1 s, at the position of the next frame.
std::vector<TruthPoint> truth_of(const std::vector<SimulatedPoint>& walk) {
  constexpr Duration kInterval = std::chrono::milliseconds(100);
  std::vector<TruthPoint> truth;
  for (const SimulatedPoint& frame : walk) {
    const Timestamp time = frame.frames.front().time;
    if (truth.empty() || time >= truth.back().begin + kInterval) {
      truth.push_back({time, time, true, frame.position});
    }
  }
  return truth;
}

Expected<StudyLayout> simulate_layout(const RoomPlan& original,
                                      const Condition& condition,
                                      std::uint64_t seed,
                                      std::size_t number) {
  const auto impairments = impairments_of(condition);
  RAYLOC_TRY(impairments);
  const auto plan = furnish(original, condition, seed, number);
  RAYLOC_TRY(plan);
  auto model = make_room(*plan, condition);
  const std::uint64_t radios = random_stream(seed, "radios", number)();
  Transmissions sent;
  auto made = make_rooms(misplace(*plan, condition, seed, number), condition, radios, sent);
  if (!model || !made) {
    return tl::make_unexpected(model ? made.error() : model.error());
  }
  StudyLayout layout{*std::move(model), {}, {}, {}, {}, std::nullopt, {}};
  const SolidObjects objects(sent.truth.room);
  StudyPlaces place{*plan, *sent.truth.room.scene, condition, std::nullopt};
  place.moved = sent.truth.moved.empty() ? nullptr : &objects;
  if (condition.kind == "person") {
    const auto at = draw_transmitter(place, seed, number);
    RAYLOC_TRY(at);
    place.transmitter = *at;
    const DeviceModel& device = layout.model.device;
    layout.transmitter = Transmitter{{*at, {}, device.pattern, device.polarization}};
  }
  RAYLOC_TRY(draw_transmissions(place, seed, number, sent));
  for (const SimulatedPoint& test_point : sent.test_points) {
    layout.test_points.push_back({test_point.position, {}});
  }
  for (const std::vector<SimulatedPoint>& walk : sent.walks) {
    layout.walks.push_back({truth_of(walk), {}});
  }
  for (const SimulatedPoint& point : sent.survey) {
    layout.survey.push_back({point.position, {}});
  }
  CaptureOptions options = capture_options(condition, *plan, layout);
  options.impairments = *impairments;
  options.seed = radios;
  RAYLOC_TRY(receive(sent, options, layout));
  return layout;
}

}  // namespace

Expected<std::vector<StudyLayout>> simulate_world(const Condition& condition, std::uint64_t seed) {
  const auto plan = load_room_plan(condition.room);
  RAYLOC_TRY(plan);
  if (!plan->rooms.empty()) {
    return make_error(ErrorKind::kConfiguration,
                      condition.room.string() +
                          ": studies move the walls of a room of four; write 'size', no outline");
  }
  if (is_walking(condition) && condition.kind != "person") {
    return make_error(ErrorKind::kConfiguration,
                      "motion = \"walk\": only people walk; state kind = \"person\", or motion = "
                      "\"still\"");
  }
  std::vector<StudyLayout> layouts;
  for (std::size_t i = 0; i < static_cast<std::size_t>(condition.layouts); ++i) {
    auto layout = simulate_layout(*plan, condition, seed, i);
    RAYLOC_TRY(layout);
    layouts.push_back(*std::move(layout));
  }
  return layouts;
}

}  // namespace rayloc
