// `rayloc train`: trains a method on the survey of a site, beside the calibration.
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "daemon/cli/calibration/calibration_progress.h"
#include "daemon/cli/command/verb.h"
#include "daemon/cli/verbs/train_survey.h"
#include "daemon/cli/verbs/training_checkpoint.h"
#include "daemon/lab/calibrate/holdout.h"
#include "daemon/lab/evaluate/error_statistics.h"
#include "daemon/methods/device_method.h"
#include "daemon/methods/method_registry.h"
#include "daemon/methods/person_method.h"
#include "daemon/site/model/room_model.h"
#include "daemon/site/model/site.h"
#include "daemon/site/model/site_copy.h"
#include "daemon/site/model/training_file.h"
#include "daemon/site/model/weights_file.h"
#include "daemon/site/survey/time_offset.h"
#include "engine/base/content_hash.h"
#include "engine/baselines/settings.h"
#include "engine/baselines/training.h"

namespace rayloc::cli {
namespace {

namespace fs = std::filesystem;

constexpr double kMaxHeldOut = 0.8;  // share of the points, as in `rayloc calibrate`

struct TrainOptions {
  std::string site;
  std::string method;
  SurveyArguments survey;
  std::string time_offset;
  std::string out;
  std::vector<std::string> baseline;
  double holdout = 0.2;
  std::uint64_t seed = 1;
  bool resume = false;
  bool force = false;
  bool quiet = false;
};

std::vector<std::string> trained_methods() {
  std::vector<std::string> names;
  for (const Method* method : methods()) {
    if (method->train != nullptr) {
      names.emplace_back(method->name);
    }
  }
  return names;
}

// One run of the verb.
class Train {
 public:
  explicit Train(const TrainOptions& options)
      : options_(options), method_(*find_method(options.method)) {}
  Expected<void> run();

 private:
  Expected<void> read();
  Expected<void> read_survey();
  TrainingInput input_of(CalibrationProgressLine& line) const;
  Expected<void> learn();
  std::string inputs_hash() const;
  Expected<LocationEstimate> locate(const std::vector<CsiFrame>& frames) const;
  Expected<void> check_held_out();
  Expected<void> write() const;
  void print() const;

  const TrainOptions& options_;
  const Method& method_;
  MethodOptions settings_;
  Site site_;
  std::shared_ptr<const RoomModel> room_;
  TrainSurvey survey_;
  std::vector<bool> held_;
  std::shared_ptr<const Training> training_;
  std::optional<ErrorStatistics> held_out_;  // errors of the points excluded from training
  double seconds_ = 0.0;
};

Expected<void> Train::read() {
  if (!(options_.holdout >= 0.0 && options_.holdout <= kMaxHeldOut)) {
    return make_error(ErrorKind::kUsage, "--holdout is a share of the points from 0 to 0.8");
  }
  for (const std::string& text : options_.baseline) {
    if (auto read =
            read_baseline_value(text, method_.name, method_.baseline_settings, settings_.values);
        !read) {
      return make_error(ErrorKind::kUsage, "--baseline " + read.error().message);
    }
  }
  settings_.seed = options_.seed;
  auto site = load_calibrated_site(options_.site,
                                   ", and methods learn in a calibrated room: run "
                                   "`rayloc calibrate` first",
                                   options_.out,
                                   options_.force || options_.resume);
  if (!site) {
    return tl::make_unexpected(std::move(site.error()));
  }
  site_ = *std::move(site);
  auto room = load_room_model(site_);
  if (!room) {
    return tl::make_unexpected(std::move(room.error()));
  }
  room_ = std::make_shared<const RoomModel>(*std::move(room));
  return read_survey();
}

Expected<void> Train::read_survey() {
  if (!options_.survey.empty.empty() && method_.create_person == nullptr) {
    return make_error(ErrorKind::kUsage, "--empty is of methods that locate people; leave it out");
  }
  SurveyArguments arguments = options_.survey;
  if (!options_.time_offset.empty()) {
    const auto offset = parse_time_offset(options_.time_offset);
    if (!offset) {
      return tl::make_unexpected(offset.error());
    }
    arguments.time_offset = *offset;
  }
  auto survey = method_.create_device != nullptr ? read_device_survey(site_, *room_, arguments)
                                                 : read_people_survey(site_, arguments);
  if (!survey) {
    return tl::make_unexpected(std::move(survey.error()));
  }
  survey_ = *std::move(survey);
  held_ = draw_holdout(survey_.points.size(), options_.holdout, options_.seed);
  return {};
}

// Hash of all inputs of the training.
std::string Train::inputs_hash() const {
  ContentHash hash;
  hash.add(survey_.content);
  hash.add(room_->calibration_id);
  hash.add(options_.method);
  hash.add(options_.holdout);
  hash.add(options_.seed);
  for (const std::string& text : options_.baseline) {
    hash.add(text);
  }
  return hash.text();
}

TrainingInput Train::input_of(CalibrationProgressLine& line) const {
  TrainingInput input;
  input.room = room_;
  input.values = settings_.values;
  input.seed = options_.seed;
  input.empty = survey_.empty;
  input.transmitter = survey_.transmitter;
  for (const SiteTransmitter& transmitter : site_.transmitters) {
    if (transmitter.constant_power) {
      input.constant_power.push_back(transmitter.mac);
    }
  }
  for (std::size_t i = 0; i < survey_.points.size(); ++i) {
    if (!held_[i]) {
      input.points.push_back(survey_.points[i]);
    }
  }
  input.progress = [&line](const TrainingProgress& progress) {
    line.show(progress.share, progress.what);
  };
  return input;
}

Expected<void> Train::learn() {
  CalibrationProgressLine line(options_.quiet);
  line.begin("train " + options_.method);
  TrainingInput input = input_of(line);
  const fs::path folder = fs::path(options_.out) / "training";
  const std::string inputs = inputs_hash();
  if (options_.resume) {
    auto reached = read_checkpoint(folder, options_.method, inputs);
    if (!reached) {
      return tl::make_unexpected(std::move(reached.error()));
    }
    input.resume = *std::move(reached);
  }
  Expected<void> kept;
  input.keep = [&](const TrainingCheckpoint& checkpoint) {
    if (kept) {
      kept = write_checkpoint(folder, options_.method, inputs, checkpoint);
    }
  };
  const auto begin = std::chrono::steady_clock::now();
  auto training = method_.train(input);
  line.clear();
  if (!training) {
    return tl::make_unexpected(std::move(training.error()));
  }
  if (!kept) {
    std::fprintf(stderr,
                 "warning: %s; after an interruption --resume could not have gone on\n",
                 kept.error().message.c_str());
  }
  training_ = *std::move(training);
  seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return check_held_out();
}

// Locates with the method and the trained values.
Expected<LocationEstimate> Train::locate(const std::vector<CsiFrame>& frames) const {
  if (method_.create_device != nullptr) {
    DeviceMethodInput input{room_, settings_};
    input.training = training_;
    auto made = method_.create_device(std::move(input));
    return made ? Expected<LocationEstimate>((*made)->locate(frames, 0))
                : tl::make_unexpected(std::move(made.error()));
  }
  PersonReference reference{};
  reference.mac = survey_.transmitter.value_or(MacAddress{});
  PersonMethodInput input{room_, std::move(reference), settings_};
  input.training = training_;
  auto made = method_.create_person(std::move(input));
  return made ? Expected<LocationEstimate>((*made)->locate(frames, 0).front())
              : tl::make_unexpected(std::move(made.error()));
}

Expected<void> Train::check_held_out() {
  std::vector<PointResult> results;
  for (std::size_t i = 0; i < survey_.points.size(); ++i) {
    if (!held_[i]) {
      continue;
    }
    TruthPoint truth;
    truth.position = survey_.points[i].position;
    const auto estimate = locate(survey_.points[i].frames);
    if (!estimate) {
      return tl::make_unexpected(estimate.error());
    }
    results.push_back(evaluate_point(truth, &*estimate));
  }
  if (!results.empty()) {
    held_out_ = compute_statistics(results, {}, {});
  }
  return {};
}

Expected<void> Train::write() const {
  const fs::path out = options_.out;
  const auto calibration = read_file(*site_.calibration_file);
  if (!calibration) {
    return tl::make_unexpected(calibration.error());
  }
  const fs::path file = out / "training" / (options_.method + ".toml");
  if (auto written = write_file(file, training_toml(*training_, site_, survey_.content));
      !written) {
    return written;
  }
  if (training_->network) {
    const std::string bytes = weights_bytes(training_->network->parameters);
    if (auto written = write_file(out / "training" / (options_.method + ".f32"), bytes); !written) {
      return written;
    }
  }
  Site site = site_;
  site.training_files.insert_or_assign(options_.method, file);
  if (auto written = write_site(site, *calibration, out); !written) {
    return written;
  }
  nlohmann::ordered_json report = {{"method", options_.method}, {"seconds", seconds_}};
  if (held_out_) {
    report["held_out"] = {{"n", held_out_->n}, {"missed", held_out_->missed}};
    if (held_out_->missed < held_out_->n) {
      report["held_out"]["median_m"] = held_out_->median_m;
      report["held_out"]["in_95"] = held_out_->coverage_95.value_or(0.0);
    }
  }
  if (training_->network) {
    report["epochs"] = training_->network->loss;
  }
  remove_checkpoint(out / "training", options_.method);
  return write_file(out / "training" / (options_.method + "-report.json"), report.dump(1) + "\n");
}

void Train::print() const {
  std::fprintf(stderr, "%s was trained in %.1f s:\n", options_.method.c_str(), seconds_);
  for (const AccessPointTraining& ap : training_->access_points) {
    if (training_->network) {
      std::fprintf(stderr, "%s: %zu places\n", ap.id.c_str(), ap.points);
      continue;
    }
    std::fprintf(stderr,
                 "%s: %zu points, phases within %.2f rad, %.0f %% outliers, ",
                 ap.id.c_str(),
                 ap.points,
                 ap.sigma_psi,
                 100.0 * ap.outliers);
    if (ap.level) {
      std::fprintf(stderr,
                   "level %.1f dBm at 1 m, exponent %.2f, within %.1f dB\n",
                   ap.level->at_1m_dbm,
                   ap.level->exponent,
                   ap.level->sigma_db);
    } else {
      std::fprintf(stderr,
                   "no level: no [[transmitter]] of the survey has constant_power = true\n");
    }
  }
  if (held_out_) {
    std::fprintf(stderr,
                 "%zu points held out: median error %.2f m, %.0f %% in their 95 %% regions\n",
                 held_out_->n,
                 held_out_->median_m,
                 100.0 * held_out_->coverage_95.value_or(0.0));
  }
}

Expected<void> Train::run() {
  if (auto done = read(); !done) {
    return done;
  }
  if (auto done = prepare_output(options_.out, options_.force || options_.resume); !done) {
    return done;
  }
  if (auto done = learn(); !done) {
    return done;
  }
  if (auto done = write(); !done) {
    return done;
  }
  if (!options_.quiet) {
    for (const std::string& note : survey_.notes) {
      std::fprintf(stderr, "%s\n", note.c_str());
    }
    print();
  }
  return {};
}

RunVerb declare_train(OptionParser& app) {
  const auto options = std::make_shared<TrainOptions>();
  app.add_option("site", options->site, "calibrated site: directory with site.toml")->required();
  app.add_option("--method", options->method, "that learns")
      ->check(one_of(trained_methods()))
      ->required();
  app.add_option("--capture", options->survey.captures, "recordings of the survey: [AP=]FILE")
      ->required();
  app.add_option("--points",
                 options->survey.points,
                 "surveyed positions of the device, or the person: t_start,t_end,x,y,z")
      ->required();
  app.add_option("--time-offset", options->time_offset, kTimeOffsetHelp);
  app.add_option("--empty",
                 options->survey.empty,
                 "recordings of the empty room, of methods that locate people: [AP=]FILE");
  app.add_option("--out", options->out, "folder to create: the site with what was learned")
      ->required();
  app.add_option("--baseline",
                 options->baseline,
                 "KEY=VALUE: settings of the method, as `rayloc replay` has them");
  app.add_option("--holdout", options->holdout, "share of the points kept for checking")
      ->capture_default_str();
  app.add_option("--seed", options->seed, "seed of the draw of those points, and of the method")
      ->capture_default_str();
  app.add_flag("--resume", options->resume, "continues the training that was interrupted in --out");
  app.add_flag("--force", options->force, "write into a folder that is not empty");
  app.add_flag("--quiet", options->quiet, "no words on stderr");
  return [options] { return Train(*options).run(); };
}

}  // namespace

extern const Verb kTrain;
const Verb kTrain = {"train",
                     "Let a method learn from a survey what it needs beside the calibration",
                     "rayloc train office-calibrated --method spotfi --capture ap1=survey.pcap "
                     "--points survey.csv --out office-trained",
                     declare_train};

}  // namespace rayloc::cli
