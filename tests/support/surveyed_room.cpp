#include "tests/support/surveyed_room.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <random>
#include <utility>

#include "engine/base/constants.h"
#include "engine/base/parallel.h"
#include "engine/trace/path_tracer.h"
#include "tests/support/box_scene.h"
#include "tests/support/scenes.h"

namespace rayloc::test {
namespace {

using Value = std::complex<double>;

constexpr double kHalfX = 1.75;  // [m]
constexpr double kHalfY = 1.45;
constexpr double kTop = 2.7;
constexpr double kWall = 0.1;
constexpr double kHeight = 1.2;     // of device and access points
constexpr double kCoupling = 0.04;  // of the antennas: -28 dB
constexpr double kClearance = 0.25;

// A face of the shell as built, along the outward normal of the room [m].
struct Shell {
  double west = 0.0;
  double east = 0.0;
  double south = 0.0;
  double north = 0.0;
  double floor = 0.0;
  double ceiling = 0.0;
};

constexpr Shell kBuilt{0.009, -0.012, 0.007, 0.011, 0.0, -0.008};

Shell scaled(const Shell& shell, double by) {
  return {by * shell.west,
          by * shell.east,
          by * shell.south,
          by * shell.north,
          by * shell.floor,
          by * shell.ceiling};
}

// Walls fit between the planes of the others: no two overlap as they move.
std::vector<SceneBox> shell_boxes(const Shell& off) {
  const double west = -kHalfX - off.west;
  const double east = kHalfX + off.east;
  const double south = -kHalfY - off.south;
  const double north = kHalfY + off.north;
  const double floor = -off.floor;
  const double top = kTop + off.ceiling;
  return {{"west", "plasterboard", {west - kWall, south, floor}, {west, north, top}},
          {"east", "plasterboard", {east, south, floor}, {east + kWall, north, top}},
          {"south", "concrete", {west, south - kWall, floor}, {east, south, top}},
          {"north", "plasterboard", {west, north, floor}, {east, north + kWall, top}},
          {"floor", "concrete", {west, south, floor - kWall}, {east, north, floor}},
          {"ceiling", "ceiling_board", {west, south, top}, {east, north, top + kWall}}};
}

// Below the height of the device, so that all positions are in line of sight.
std::vector<SceneBox> furniture_boxes(int count) {
  std::vector<SceneBox> boxes{{"table", "wood", {-0.5, -0.35, 0.70}, {0.6, 0.35, 0.74}},
                              {"cabinet", "metal", {1.3, -1.4, 0.02}, {1.7, -0.6, 1.0}},
                              {"shelf", "wood", {-1.7, -1.4, 0.02}, {-1.4, -0.5, 1.05}},
                              {"drawers", "wood", {-0.3, 1.05, 0.02}, {0.4, 1.4, 0.6}},
                              {"bin", "metal", {0.8, 1.1, 0.02}, {1.0, 1.3, 0.4}},
                              {"chair", "wood", {-1.1, -0.2, 0.42}, {-0.7, 0.2, 0.46}},
                              {"stool", "wood", {0.8, -0.2, 0.42}, {1.2, 0.2, 0.46}},
                              {"chest", "metal", {-0.4, -1.4, 0.02}, {0.3, -1.1, 0.5}}};
  boxes.resize(static_cast<std::size_t>(count));
  return boxes;
}

const std::map<std::string, double>& permittivity_factors() {
  static const std::map<std::string, double> kFactors{{"plasterboard", 1.10}, {"concrete", 0.93}};
  return kFactors;
}

// `plasterboard`: its thickness [m]; 0: that of the table.
std::shared_ptr<const Scene> with_other_materials(const Scene& scene,
                                                  double error,
                                                  double plasterboard) {
  Scene::Input input{scene.objects(), scene.materials(), scene.carrier_hz()};
  for (RadioMaterial& material : input.materials) {
    if (const auto factor = permittivity_factors().find(material.name);
        factor != permittivity_factors().end()) {
      material.relative_permittivity *= std::pow(factor->second, error);
    }
    if (material.name == "plasterboard" && plasterboard > 0.0) {
      material.thickness = plasterboard;
    }
  }
  return std::make_shared<const Scene>(Scene::create(std::move(input)).value());
}

OfdmGrid make_grid(int tones) {
  OfdmGrid grid{kCarrier, 312'500.0, {}};
  for (int i = 0; i < tones; ++i) {
    grid.tone_index.push_back(
        static_cast<std::int16_t>(std::lround(-58 + 116.0 * i / (tones - 1))));
  }
  return grid;
}

RoomAccessPoint make_access_point(const std::string& id, double x, double y) {
  RoomAccessPoint ap;
  ap.id = id;
  ap.array.pose.position = {x, y, kHeight};
  ap.array.pose.orientation.yaw = std::atan2(-y, -x);  // faces the middle
  ap.array.element_offset = {{0.0, -0.089, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.089, 0.0}};
  ap.array.pattern = AntennaPattern::kHalfWaveDipole;
  ap.rx_chains = {2, 0, 3};
  return ap;
}

ChainGains make_gains(const RoomModel& room, std::size_t access_point, double error) {
  const RoomAccessPoint& ap = room.access_points[access_point];
  ChainGains gains{room.grid, ap.rx_chains, {}, {}};
  for (std::size_t rx_chain = 0; rx_chain < ap.rx_chains.size(); ++rx_chain) {
    const auto number = static_cast<double>(rx_chain + 3 * access_point);
    const Value level = rx_chain == 0 ? Value(1.0)
                                      : std::polar(1.0 + 0.1 * error * std::sin(number),
                                                   0.2 * error * std::cos(2.1 * number));
    gains.gain.insert(gains.gain.end(), room.grid.size(), level);
  }
  for (std::size_t i = 0; error != 0.0 && i < ap.rx_chains.size() * ap.rx_chains.size(); ++i) {
    const auto number = static_cast<double>(i + 9 * access_point);
    gains.coupling.push_back(i % (ap.rx_chains.size() + 1) == 0
                                 ? Value(1.0)
                                 : std::polar(kCoupling * error, 2.3 * number));
  }
  return gains;
}

// Error of the array's position and orientation relative to the plan.
struct ArrayError {
  Vec3d position;  // [m]
  double yaw;      // [rad]
};
constexpr std::array<ArrayError, 3> kArrayErrors{{{{0.004, -0.003, 0.002}, 1.0 * kDegree},
                                                  {{-0.002, 0.005, -0.003}, -0.8 * kDegree},
                                                  {{0.003, 0.002, 0.004}, 0.6 * kDegree}}};

void state_coupling(const RoomAccessPoint& ap, std::map<std::string, double>& truth) {
  const std::size_t rx_chains = ap.rx_chains.size();
  for (std::size_t i = 0; i < ap.gains.coupling.size(); ++i) {
    const std::string name = ap.id + ".core" + std::to_string(ap.rx_chains[i / rx_chains]) +
                             "/core" + std::to_string(ap.rx_chains[i % rx_chains]) + ".coupling";
    truth[name + ".re"] = ap.gains.coupling[i].real();
    truth[name + ".im"] = ap.gains.coupling[i].imag();
  }
}

void state_truth(const Shell& off, double error, SurveyedRoom& room) {
  // Each face's normal points into the room, opposite to the outward direction.
  room.truth = {{"west.+x.offset", -off.west},
                {"east.-x.offset", -off.east},
                {"south.+y.offset", -off.south},
                {"north.-y.offset", -off.north},
                {"floor.+z.offset", -off.floor},
                {"ceiling.-z.offset", -off.ceiling}};
  for (const RadioMaterial& material : room.built.scene->materials()) {
    room.truth[material.name + ".relative_permittivity"] = material.relative_permittivity;
  }
  for (std::size_t i = 0; i < room.plan.access_points.size(); ++i) {
    const std::string& id = room.plan.access_points[i].id;
    room.truth[id + ".position.x"] = error * kArrayErrors.at(i).position.x;
    room.truth[id + ".position.y"] = error * kArrayErrors.at(i).position.y;
    room.truth[id + ".position.z"] = error * kArrayErrors.at(i).position.z;
    room.truth[id + ".yaw"] = error * kArrayErrors.at(i).yaw;
    state_coupling(room.built.access_points[i], room.truth);
  }
}

std::vector<Vec3d> places(const std::vector<SceneBox>& furniture,
                          const RoomModel& room,
                          std::size_t count,
                          std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<Vec3d> result;
  while (result.size() < count) {
    const Vec3d place{
        (kHalfX - kClearance) * uniform(random), (kHalfY - kClearance) * uniform(random), kHeight};
    const bool near = std::any_of(
        room.access_points.begin(), room.access_points.end(), [&](const RoomAccessPoint& ap) {
          return norm(ap.array.pose.position - place) < 2.0 * kClearance;
        });
    if (!near && is_free(furniture, place, 0.02)) {
      result.push_back(place);
    }
  }
  return result;
}

// [rx_chain][tone], with the chain gains, noise, and the unknown factor and delay of a burst.
std::vector<Value> received(const RoomModel& room,
                            const RoomAccessPoint& ap,
                            const Vec3d& position,
                            double snr_db,
                            unsigned seed) {
  const PathTracer tracer(room.scene, room.trace);
  const Transmitter device{{position, {}, room.device.pattern, room.device.polarization}};
  std::vector<Value> h;
  for (const Receiver& element : array_elements<Receiver>(ap.array)) {
    const auto row = tracer.trace(device, element).cfr(room.grid);
    h.insert(h.end(), row.begin(), row.end());
  }
  apply_coupling(ap.gains, h);
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const Value factor = std::polar(1.0, 6.3 * normal(random));
  const double delay = 1e-9 * normal(random);
  double power = 0.0;
  for (const Value& value : h) {
    power += std::norm(value) / static_cast<double>(h.size());
  }
  const double sigma = std::sqrt(0.5 * power * std::pow(10.0, -0.1 * snr_db));
  for (std::size_t j = 0; j < h.size(); ++j) {
    const double turn = -2.0 * std::numbers::pi * room.grid.offset_hz(j % room.grid.size()) * delay;
    const double real = sigma * normal(random);
    h[j] = factor * std::polar(1.0, turn) * ap.gains.gain[j] * h[j] +
           Value(real, sigma * normal(random));
  }
  return h;
}

}  // namespace

SurveyedRoom make_surveyed_room(const SurveyedRoomOptions& options) {
  const auto furniture = furniture_boxes(options.furniture);
  const auto scene = [&](const Shell& off) {
    auto boxes = shell_boxes(off);
    boxes.insert(boxes.end(), furniture.begin(), furniture.end());
    return scene_of_boxes(boxes);
  };
  SurveyedRoom room;
  room.plan.name = "surveyed";
  room.plan.scene = with_other_materials(*scene({}), 0.0, options.plasterboard);
  room.plan.bounds_min = {-kHalfX, -kHalfY, 0.0};
  room.plan.bounds_max = {kHalfX, kHalfY, kTop};
  room.plan.grid = make_grid(options.tones);
  room.plan.device.height = kHeight;
  room.plan.trace = options.trace;
  const std::array<RoomAccessPoint, 3> all{make_access_point("a", -1.4, 1.15),
                                           make_access_point("b", 1.45, 1.0),
                                           make_access_point("c", -0.2, -1.2)};
  room.plan.access_points.assign(all.begin(), all.begin() + options.access_points);
  for (std::size_t i = 0; i < room.plan.access_points.size(); ++i) {
    room.plan.access_points[i].gains = make_gains(room.plan, i, 0.0);
  }
  room.built = room.plan;
  const Shell off = scaled(kBuilt, options.error);
  room.built.scene = with_other_materials(*scene(off), options.error, options.plasterboard);
  for (std::size_t i = 0; i < room.built.access_points.size(); ++i) {
    RoomAccessPoint& ap = room.built.access_points[i];
    ap.array.pose.position = ap.array.pose.position + options.error * kArrayErrors.at(i).position;
    ap.array.pose.orientation.yaw += options.error * kArrayErrors.at(i).yaw;
    ap.gains = make_gains(room.plan, i, options.error);
  }
  state_truth(off, options.error, room);
  std::mt19937 random(options.seed);
  std::normal_distribution<double> survey(0.0, 1.0);
  for (const Vec3d& place :
       places(furniture, room.plan, static_cast<std::size_t>(options.points), random)) {
    room.points.push_back({place, room.points.size() % 5 == 2, {}});
    const double x = survey(random);
    const double y = survey(random);
    room.survey_error.push_back(options.survey * Vec3d{x, y, survey(random)});
  }
  parallel_for(room.points.size(), 1, [&](std::size_t p) {
    CalibrationPoint& point = room.points[p];
    for (std::size_t a = 0; a < room.built.access_points.size(); ++a) {
      point.h.push_back(received(room.built,
                                 room.built.access_points[a],
                                 point.position + room.survey_error[p],
                                 options.snr_db,
                                 static_cast<unsigned>(1 + 8 * p + a) + 1000 * options.seed));
    }
  });
  return room;
}

}  // namespace rayloc::test
