// Condition: one setting of a study: the room, its clutter, the receivers, the localization method.
//
// condition_keys() and engine/paper/settings.h define the keys of an experiment's file
// completely: reading, defaults, the text of `rayloc experiment --help` and the columns of the
// report come from them. Any of them can be an axis of a study.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "daemon/site/model/number_range.h"
#include "engine/paper/options.h"

namespace rayloc {

struct Condition {
  // The simulated world. Equal worlds give equal frames.
  std::filesystem::path room;      // a plan of `rayloc scene room`
  std::string kind;                // kind of the located target
  double access_points = 0;        // the first ones in the plan
  double ap_height_m = 0.0;        // 0: as in the plan
  double antenna_spacing_m = 0.0;  // of access points; 0: as in the plan
  std::string channels;            // hop channels of devices; "plan": no hopping
  double device_height_m = 0.0;
  double height_sigma_m = 0.0;        // of devices around their height
  double model_height_sigma_m = 0.0;  // the same, as assumed by the model
  double tilt_deg = 0.0;              // largest angle of the device from upright
  double power_sigma_db = 0.0;        // of the device, between test points
  std::string second_day;             // on which test points are visited: none, default or a file
  double person_radius_m = 0.0;       // of people; the model assumes 0.165 m
  double boxes = 0;                   // clutter boxes in addition to the plan's
  double distance_m = 0.0;            // of test points from the first access point; 0: any
  std::string sight;                  // from the first access point: any, los, nlos
  double layouts = 0;                 // with their own clutter and test points
  double test_points = 0;             // in each layout
  double survey_points = 0;           // training points of learning methods and controls
  double frames = 0;                  // per test point
  std::string motion;                 // of people: still or walk; then test points are walks
  double walk_s = 0.0;                // duration of a walk
  double walk_speed_m_s = 0.0;        // constant
  double rate_hz = 0.0;               // of frames during a walk
  double depth = 0;                   // reflections of the simulated paths
  double plan_error_m = 0.0;          // deviation of walls and boxes from the model's plan
  std::string impairments;            // of the radio: default, none or a file
  // The method.
  std::string method;
  std::string likelihood;     // for method rayloc
  double epochs = 0;          // of training; 0: the method's default
  double constant_power = 0;  // 1: received power may be learned and used
  std::string chains;         // assumed by the model: known, or first_day
  double model_depth = 0;     // reflections in the model
  double repeats = 0;         // locations per test point with other random numbers; method paper
  double multi_start = 0;     // random starts per location, least loss wins; method paper
  std::map<std::string, double, std::less<>> paper;  // stated values, by key of paper::settings()

  // With the defaults of the located kind.
  paper::LocalizerOptions paper_options() const;
};

struct ConditionKey {
  std::string_view key;
  // Files are relative to the experiment's file.
  std::variant<double Condition::*, std::string Condition::*, std::filesystem::path Condition::*>
      member;
  std::string_view preset;                  // empty: must be stated
  NumberRange range = {};                   // for a number
  bool is_whole = false;                    // for a number
  std::span<const std::string_view> names;  // for a string; empty: any
  bool is_world = true;
  std::string_view meaning;
  // Adds a report column only if a condition states a value other than the preset, so that reports
  // of experiments without the key stay unchanged.
  bool only_where_used = false;
};

bool is_walking(const Condition& condition);

// True if the condition's method is a control: a baseline that uses nothing, or only the survey.
bool is_control(const Condition& condition);

std::span<const ConditionKey> condition_keys();

// A condition with the default values.
Condition default_condition();

// The value of a key of either table ("boxes", "paper.alpha") as a file states it. The value of a
// file is its name without folder and extension. REQUIRES: such a key.
std::string condition_text(const Condition& condition, std::string_view key);

// The same as a number, for an axis of a chart; empty for a string or a flag.
std::optional<double> condition_number(const Condition& condition, std::string_view key);

// The keys of both tables for reports of these conditions:
// all but those of only_where_used that none of them uses.
std::vector<std::string> reported_keys(std::span<const Condition* const> conditions);

// Identifies worlds, and within them models: equal texts mean equal frames, equal rooms.
std::string world_text(const Condition& condition);

// One line per key: its name, default and meaning, and the default for people if different.
std::string experiment_help();

}  // namespace rayloc
