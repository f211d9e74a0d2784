// Condition: one setting of a study: the room, what stands in it, who listens, how it is located.
//
// condition_keys() and engine/paper/paper_settings.h are all there is to know of the keys of an
// experiment's file: reading, defaults, the text of `rayloc experiment --help` and the columns of
// the report come from them. Any of them can be an axis of a study.
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

#include "daemon/site/number_range.h"
#include "engine/paper/paper_options.h"

namespace rayloc {

struct Condition {
  // The world: what is simulated. Equal worlds give equal frames.
  std::filesystem::path room;      // a plan of `rayloc scene room`
  std::string kind;                // what is located
  double access_points = 0;        // the first ones of the plan
  double ap_height_m = 0.0;        // 0: that of the plan
  double antenna_spacing_m = 0.0;  // of access points; 0: that of the plan
  std::string channels;            // that devices hop over; "plan": they do not
  double device_height_m = 0.0;
  double height_sigma_m = 0.0;        // of devices about it
  double model_height_sigma_m = 0.0;  // the same, as the model expects it
  double tilt_deg = 0.0;              // of the device from upright, at most
  double power_sigma_db = 0.0;        // of the device, from spot to spot
  std::string second_day;             // on which the spots are visited: none, default or a file
  double person_radius_m = 0.0;       // of people; the model believes 0.165 m
  double boxes = 0;                   // of clutter, besides what the plan states
  double distance_m = 0.0;            // of spots from the first access point; 0: any
  std::string sight;                  // from the first access point: any, los, nlos
  double layouts = 0;                 // with clutter and spots of their own
  double spots = 0;                   // in each layout
  double survey_points = 0;           // at which methods that learn, and controls, were trained
  double frames = 0;                  // of each spot
  std::string motion;                 // of people: still or walk; then spots are walks
  double walk_s = 0.0;                // duration of a walk
  double walk_speed_m_s = 0.0;        // constant
  double rate_hz = 0.0;               // of frames during a walk
  double depth = 0;                   // reflections of the simulated paths
  double plan_error_m = 0.0;          // deviation of walls and boxes from what the model believes
  std::string impairments;            // of the radio: default, none or a file
  // The method.
  std::string method;
  std::string likelihood;     // of method rayloc
  double epochs = 0;          // of training; 0: as the method has them
  double constant_power = 0;  // 1: levels may be learned and used
  std::string chains;         // what the model believes of them: known, or first_day
  double model_depth = 0;     // reflections that the model knows
  double repeats = 0;         // locations of each spot, with other random numbers; of method paper
  double multi_start = 0;     // random starts of one location, the least loss wins; of method paper
  std::map<std::string, double, std::less<>> paper;  // by key of paper_settings(): what is stated

  // With the defaults of the kind that is located.
  PaperLocalizerOptions paper_options() const;
};

struct ConditionKey {
  std::string_view key;
  // Files are relative to the experiment's.
  std::variant<double Condition::*, std::string Condition::*, std::filesystem::path Condition::*>
      member;
  std::string_view preset;                  // empty: must be stated
  NumberRange range = {};                   // of a number
  bool is_whole = false;                    // of a number
  std::span<const std::string_view> names;  // of a string; empty: any
  bool is_world = true;
  std::string_view meaning;
  // A column of the report only where a condition states another value than the preset, so that
  // reports of experiments that do not know the key stay as they are.
  bool only_where_used = false;
};

bool is_walking(const Condition& condition);

// Whether the condition's method is a control: what it takes nothing, or only the survey, to reach.
bool is_control(const Condition& condition);

std::span<const ConditionKey> condition_keys();

// With the defaults.
Condition default_condition();

// The value of a key of either table ("boxes", "paper.alpha") as a file states it. A file's is its
// name without folder and extension. REQUIRES: such a key.
std::string condition_text(const Condition& condition, std::string_view key);

// The same as a number, for an axis of a chart; nothing for a string or a flag.
std::optional<double> condition_number(const Condition& condition, std::string_view key);

// The keys of both tables that reports of these conditions have: all but those of only_where_used
// that none of them uses.
std::vector<std::string> reported_keys(std::span<const Condition* const> conditions);

// What tells apart worlds, and within them models: equal texts mean equal frames, equal rooms.
std::string world_text(const Condition& condition);

// A line a key: its name, default and meaning, and the default for people where that is another.
std::string experiment_help();

}  // namespace rayloc
