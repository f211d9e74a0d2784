#include "daemon/lab/calibrate/calibrate_rechain.h"

#include <algorithm>
#include <chrono>
#include <complex>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <spdlog/fmt/fmt.h>
#include <nlohmann/json.hpp>

#include "daemon/lab/calibrate/calibrated_site.h"
#include "daemon/lab/calibrate/calibration_inputs.h"
#include "daemon/lab/calibrate/fit_observer.h"
#include "daemon/lab/calibrate/learned_chains.h"
#include "daemon/lab/calibrate/unsurveyed/plan_calibration.h"
#include "daemon/lab/recordings/fixed_frames.h"
#include "daemon/site/model/calibration_file.h"
#include "daemon/site/model/reference_file.h"
#include "daemon/site/model/room_model.h"
#include "daemon/site/model/site_copy.h"
#include "daemon/site/scene/scene_notes.h"
#include "engine/base/content_hash.h"
#include "engine/calibrate/chain_refit.h"
#include "engine/chains/chain_progress.h"
#include "engine/observe/burst.h"

namespace rayloc {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// Counts the uncertainty of the chain phases as power that the room does not explain, if it exceeds
// the rest of the model error. The value of the calibration stays as `prior` for the next run; a
// value that was not fitted has no sigma.
void count_phases(const std::vector<double>& sigma, CalibratedAccessPoint& access_point) {
  double variance = 0.0;
  for (const double one : sigma) {
    variance += one * one / static_cast<double>(sigma.size());
  }
  // A phase that all chains have in common carries no information.
  variance *= 1.0 - 1.0 / static_cast<double>(sigma.size());
  Fitted<double>& noise = access_point.noise;
  const double calibrated = noise.sigma > 0.0 ? noise.value : noise.prior;
  noise = {std::max(calibrated, std::min(variance, 1.0)), calibrated, 0.0};
}

// Frames of one transmitter at a known position, from all access points.
struct PointFrames {
  Vec3d position;
  DeviceModel device;
  std::vector<CsiFrame> frames;
  std::optional<MacAddress> fixed;  // address of a fixed transmitter
};

// Known positions and the frames received from them.
struct RefitInputs {
  std::vector<PointFrames> points;
  std::vector<bool> recorded;  // by access point
  std::vector<RefusedInput> refused;
  std::string content;             // hash of the content
  std::vector<std::string> notes;  // from the recordings
};

struct RefitAccessPoint {
  std::size_t index = 0;
  ChainRefit refit;  // gains and sigma of the learned chains
  std::optional<UsualFit> usual;
  std::size_t learned_from = 0;  // bursts of devices; 0: refitted from known positions
};

Expected<RefitInputs> read_surveyed(const Site& site,
                                    const RoomModel& room,
                                    const std::vector<CaptureArgument>& captures,
                                    const RechainArguments& arguments) {
  auto inputs = read_calibration_inputs(
      with_bounds(site, room), captures, arguments.points, arguments.time_offset);
  RAYLOC_TRY(inputs);
  RefitInputs received{{},
                       std::move(inputs->recorded),
                       std::move(inputs->refused),
                       inputs->content,
                       std::move(inputs->notes)};
  for (SurveyedFrames& surveyed : inputs->points) {
    received.points.push_back(
        {surveyed.point.position, room.device, std::move(surveyed.frames), {}});
  }
  return received;
}

// Frames of the fixed transmitters whose positions are stated.
Expected<RefitInputs> read_fixed(const Site& site, const std::vector<CaptureArgument>& captures) {
  const auto has_place = [](const SiteTransmitter& transmitter) {
    return transmitter.role == TransmitterRole::kFixed && transmitter.position;
  };
  RefitInputs received;
  auto frames = read_fixed_frames(site, captures, received.notes);
  RAYLOC_TRY(frames);
  for (const SiteTransmitter& transmitter : site.transmitters) {
    if (has_place(transmitter)) {
      received.points.push_back({*transmitter.position,
                                 device_model(transmitter),
                                 std::move((*frames)[transmitter.mac]),
                                 transmitter.mac});
    }
  }
  received.recorded.resize(site.access_points.size());
  for (const CaptureArgument& capture : captures) {
    received.recorded[*find_access_point(site, capture.access_point)] = true;
  }
  return received;
}

// `heldout` of the report beside the calibration; null if there is none.
Json usual_fits(const Site& site) {
  const auto text = read_file(site.calibration_file->parent_path() / "report.json");
  const Json report = text ? Json::parse(*text, nullptr, false) : Json();
  return report.is_object() && report.contains("heldout") ? report["heldout"] : Json();
}

std::optional<UsualFit> usual_fit(const Json& heldout, const std::string& access_point) {
  if (!heldout.is_object() || !heldout.contains(access_point)) {
    return std::nullopt;
  }
  // Fit with the rays of a chain refit; an older report has only those of its method.
  const Json& one = heldout[access_point];
  const std::string after =
      one.contains("quartiles_after_as_located") ? "after_as_located" : "after";
  const Json median = one.value(after, Json());
  const Json quartiles = one.value("quartiles_" + after, Json());
  if (!median.is_number() || !quartiles.is_array() || quartiles.size() != 2 ||
      !quartiles[0].is_number() || !quartiles[1].is_number()) {
    return std::nullopt;
  }
  return UsualFit{median, quartiles[0], quartiles[1]};
}

// Channel of the transmitter at the access point in the empty room; empty without a reference.
std::vector<std::complex<double>> empty_room(const std::vector<PersonReference>& references,
                                             const std::optional<MacAddress>& transmitter,
                                             std::size_t access_point) {
  for (const PersonReference& reference : references) {
    for (const PersonLink& link : reference.links) {
      if (reference.mac == transmitter && link.access_point == access_point) {
        return link.empty;
      }
    }
  }
  return {};
}

Json chains_json(const std::vector<ChainChange>& chains) {
  const auto values = [](const ChainValues& one) {
    return Json{{"gain_db", one.gain_db}, {"phase_deg", one.phase_deg}};
  };
  Json all = Json::array();
  for (const ChainChange& one : chains) {
    all.push_back({{"core", one.rx_chain},
                   {"against", one.against},
                   {"before", values(one.before)},
                   {"after", values(one.after)},
                   {"sigma", values(one.sigma)}});
  }
  return all;
}

// One run on a site.
class Rechain {
 public:
  Rechain(const RechainArguments& arguments, const Observer& observer)
      : arguments_(arguments), observer_(observer) {}
  Expected<RechainResult> run();

 private:
  Expected<void> read();
  Expected<void> read_calibration();
  Expected<void> refit();
  Expected<void> write(const RechainResult& result);
  std::vector<ReferencePoint> reference_points_of(std::size_t access_point, ContentHash& content);
  Expected<RefitAccessPoint> refit(std::size_t access_point, ContentHash& content);
  const ChainState* learned(std::size_t access_point) const;
  std::string why_not_learned(std::size_t access_point) const;
  std::vector<ChainChange> changes(const RefitAccessPoint& result) const;
  RechainResult result() const;
  Json report(const RechainResult& result) const;

  const RechainArguments& arguments_;
  const Observer& observer_;
  const std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  Site site_;
  RoomModel room_;
  std::vector<PersonReference> references_;
  CalibrationFile before_;
  CalibrationFile after_;
  RefitInputs received_;
  Json heldout_;
  std::vector<ChainState> states_;  // learned from devices; empty with --points
  std::vector<RefitAccessPoint> results_;
};

// Reads the known chains and model; for a plan, the usual errors of plans.
Expected<void> Rechain::read_calibration() {
  if (arguments_.unsurveyed) {
    before_ = plan_calibration(room_);
    for (std::size_t a = 0; a < room_.access_points.size(); ++a) {
      room_.access_points[a].gains = before_.access_points[a].gains;
    }
  } else {
    auto calibration = load_calibration_file(*site_.calibration_file);
    RAYLOC_TRY(calibration);
    before_ = *std::move(calibration);
    heldout_ = usual_fits(site_);
  }
  return {};
}

Expected<void> Rechain::read() {
  auto site = arguments_.unsurveyed
                  ? load_uncalibrated_site(arguments_.site, arguments_.out, arguments_.force)
                  : load_calibrated_site(
                        arguments_.site,
                        "; --rechain only renews the chain gains of a calibrated site: run "
                        "`rayloc calibrate` with a survey first, or with --unsurveyed",
                        arguments_.out,
                        arguments_.force);
  RAYLOC_TRY(site);
  site_ = *std::move(site);
  auto room = load_room_model(site_);
  RAYLOC_TRY(room);
  room_ = *std::move(room);
  note_scene(*room_.scene, observer_);
  auto references = load_references(site_, room_);
  RAYLOC_TRY(references);
  references_ = *std::move(references);
  RAYLOC_TRY(read_calibration());
  const auto captures =
      resolve_captures(arguments_.captures, access_point_ids(site_), PerAccessPoint::kSeveral);
  RAYLOC_TRY(captures);
  auto received = arguments_.points.empty() ? read_fixed(site_, *captures)
                                            : read_surveyed(site_, room_, *captures, arguments_);
  RAYLOC_TRY(received);
  received_ = *std::move(received);
  if (arguments_.points.empty()) {
    std::vector<std::string> repeated_notices;
    auto states = learn_chains(site_, room_, *captures, repeated_notices);
    RAYLOC_TRY(states);
    states_ = *std::move(states);
  }
  for (const std::string& note : received_.notes) {
    observer_.note(note);
  }
  return {};
}

std::vector<ReferencePoint> Rechain::reference_points_of(std::size_t access_point,
                                                         ContentHash& content) {
  const RoomAccessPoint& ap = room_.access_points[access_point];
  std::vector<ReferencePoint> points;
  for (const PointFrames& point : received_.points) {
    auto burst = combine_burst(point.frames, {access_point, room_.grid, ap.rx_chains, {}});
    if (!burst) {
      received_.refused.push_back({fmt::format("{} at ({:g}, {:g}, {:g})",
                                               ap.id,
                                               point.position.x,
                                               point.position.y,
                                               point.position.z),
                                   burst.error().message});
      continue;
    }
    for (const auto& value : burst->h) {
      content.add(value.real());
      content.add(value.imag());
    }
    points.push_back({point.position,
                      point.device,
                      std::move(burst->h),
                      empty_room(references_, point.fixed, access_point)});
  }
  return points;
}

const ChainState* Rechain::learned(std::size_t access_point) const {
  const auto found = std::find_if(states_.begin(), states_.end(), [&](const ChainState& state) {
    return state.access_point == access_point && state.knowledge == ChainKnowledge::kLearned;
  });
  return found == states_.end() ? nullptr : &*found;
}

std::string Rechain::why_not_learned(std::size_t access_point) const {
  for (const ChainState& state : states_) {
    if (state.access_point == access_point) {
      return fmt::format(
          "the frames of devices are too few to learn its chains ({}); record a device that is "
          "carried through the room for a minute",
          progress_text(state));
    }
  }
  return "its recording holds no frame of a device or of a fixed transmitter of the site";
}

Expected<RefitAccessPoint> Rechain::refit(std::size_t access_point, ContentHash& content) {
  const RoomAccessPoint& ap = room_.access_points[access_point];
  if (const ChainState* state = learned(access_point)) {
    for (const std::complex<double>& factor : state->factors.factor) {
      content.add(factor.real());
      content.add(factor.imag());
    }
    RefitAccessPoint result{access_point, {}, std::nullopt, state->bursts};
    result.refit.gains = multiplied(ap.gains, state->factors);
    result.refit.sigma = state->factors.sigma;
    return result;
  }
  const auto points = reference_points_of(access_point, content);
  if (points.empty()) {
    return bad_input(
        "access point " + ap.id + ": " +
        (arguments_.points.empty() ? why_not_learned(access_point) : "no known place has frames"));
  }
  ChainRefitOptions options;
  options.usual = usual_fit(heldout_, ap.id);
  auto refit = refit_chains(room_, access_point, points, options);
  RAYLOC_TRY(refit);
  return RefitAccessPoint{access_point, *std::move(refit), options.usual, 0};
}

Expected<void> Rechain::refit() {
  after_ = before_;
  ContentHash content;
  content.add(before_.id);
  content.add("rechain");
  for (std::size_t a = 0; a < room_.access_points.size(); ++a) {
    const RoomAccessPoint& ap = room_.access_points[a];
    if (!received_.recorded[a] || ap.gains.empty()) {
      received_.refused.push_back({ap.id,
                                   received_.recorded[a] ? "was not calibrated"
                                   : arguments_.unsurveyed
                                       ? "it has no recording; record it as well"
                                       : "no recording: keeps its gains"});
      continue;
    }
    if (arguments_.unsurveyed && learned(a) == nullptr) {
      received_.refused.push_back({ap.id, why_not_learned(a)});  // raylocd may learn them later
      continue;
    }
    auto result = refit(a, content);
    RAYLOC_TRY(result);
    for (CalibratedAccessPoint& stated : after_.access_points) {
      if (stated.id == ap.id) {
        stated.gains = result->refit.gains;
        stated.gain_sigma = result->refit.sigma;
        count_phases(result->refit.sigma, stated);
      }
    }
    results_.push_back(*std::move(result));
  }
  after_.id = content.text();
  if (arguments_.unsurveyed && results_.empty()) {
    const RefusedInput& first = received_.refused.front();
    return bad_input("access point " + first.what + ": " + first.reason);
  }
  return {};
}

// Mean phase and gain of every chain against the first.
std::vector<ChainChange> Rechain::changes(const RefitAccessPoint& result) const {
  const std::string& id = room_.access_points[result.index].id;
  const auto parameters_of = [&](const CalibrationFile& file) {
    for (const CalibratedAccessPoint& ap : file.access_points) {
      if (ap.id == id) {
        return chain_parameters(ap);  // gain and phase of each rx chain but the first
      }
    }
    return std::vector<RoomParameter>();
  };
  const auto before = parameters_of(before_);
  const auto after = parameters_of(after_);
  const auto& rx_chains = result.refit.gains.rx_chains;
  std::vector<ChainChange> chains;
  for (std::size_t i = 0; i + 1 < after.size(); i += 2) {
    chains.push_back({rx_chains[1 + i / 2],
                      rx_chains[0],
                      {before[i].value, before[i + 1].value},
                      {after[i].value, after[i + 1].value},
                      {after[i].sigma, after[i + 1].sigma}});
  }
  return chains;
}

RechainResult Rechain::result() const {
  RechainResult result{{}, received_.refused};
  for (const RefitAccessPoint& one : results_) {
    result.access_points.push_back(
        {room_.access_points[one.index].id,
         one.learned_from,
         one.refit.points,
         one.refit.ripple,
         one.learned_from > 0 ? std::nullopt : std::optional(one.refit.fit),
         one.usual ? std::optional(one.usual->median) : std::nullopt,
         changes(one)});
  }
  return result;
}

Json Rechain::report(const RechainResult& result) const {
  Json access_points = Json::array();
  for (const RechainedAccessPoint& one : result.access_points) {
    access_points.push_back({{"id", one.id},
                             {"learned_from_bursts", one.learned_from},
                             {"spots", one.points},
                             {"ripple", one.ripple},
                             {"fit", one.fit ? Json(*one.fit) : Json()},
                             {"usual_fit", one.usual_fit ? Json(*one.usual_fit) : Json()},
                             {"chains", chains_json(one.chains)}});
  }
  Json refused = Json::array();
  for (const RefusedInput& one : result.refused) {
    refused.push_back({{"what", one.what}, {"reason", one.reason}});
  }
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin_;
  return {{"method", "rechain"},
          {"site", site_.name},
          {"calibration_id", after_.id},
          {"room_calibration_id", before_.id},
          {"source", arguments_.points.empty() ? "transmitters" : "points"},
          {"seconds", taken.count()},
          {"access_points", std::move(access_points)},
          {"heldout", heldout_},
          {"refused", std::move(refused)}};
}

Expected<void> Rechain::write(const RechainResult& result) {
  const fs::path out = arguments_.out;
  RAYLOC_TRY(prepare_output(out, arguments_.force));
  RAYLOC_TRY(write_site(site_, to_toml(after_), out));
  if (site_.reference_file) {
    const auto reference = read_file(*site_.reference_file);
    RAYLOC_TRY(reference);
    RAYLOC_TRY(write_file(out / "reference.toml", reference_of_calibration(*reference, after_.id)));
  }
  return write_file(out / "report.json", report(result).dump(2) + "\n");
}

Expected<RechainResult> Rechain::run() {
  if (auto done = read().and_then([&] { return refit(); }); !done) {
    return tl::make_unexpected(std::move(done.error()));
  }
  RechainResult renewed = result();
  return write(renewed).map([&] { return std::move(renewed); });
}

}  // namespace

Expected<RechainResult> run_rechain(const RechainArguments& arguments, const Observer& observer) {
  return Rechain(arguments, observer).run();
}

}  // namespace rayloc
