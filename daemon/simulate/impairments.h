// Impairments: what the radio of an access point does to the channel at its antennas on the way to
// the reported CSI. Numbers are in the units of the file that states them, as their names say.
//
// A value of zero (or false) switches an impairment off; all of them off leave what the format
// itself costs, mantissas of 11 bits and power in whole dBm. The defaults are those measured on
// recordings of bcm43684 (AX-CSI) or, where no recording tells, those of the project's datasets.
//
// impairment_keys() is all there is to know of the file's keys: reading, defaults and the text of
// `rayloc simulate --help` come from it, and a row stores its value.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "daemon/site/number_range.h"
#include "engine/base/expected.h"

namespace rayloc {

struct Impairments {
  // Of every frame.
  bool random_phase = false;
  double delay_min_ns = 0.0;
  double delay_max_ns = 0.0;
  double delay_outlier_share = 0.0;
  double delay_outlier_ns = 0.0;
  double gain_step_db = 0.0;
  double power_error_db = 0.0;
  double phase_jitter_deg = 0.0;
  double snr_db = 0.0;
  double transmit_snr_db = 0.0;
  bool dc_garbage = false;
  // Of a power cycle.
  bool calibrated_chains = false;
  double chain_gain_db = 0.0;
  double chain_phase_deg = 0.0;
  double chain_delay_ns = 0.0;
  double ripple_db = 0.0;
  double ripple_deg = 0.0;
  double coupling_db = 0.0;
  double image_rejection_db = 0.0;
  // Of the traffic.
  double retry_share = 0.0;
  double loss_share = 0.0;
  double transmit_power_dbm = 0.0;
};

struct ImpairmentKey {
  std::string_view key;
  std::variant<bool Impairments::*, double Impairments::*> member;
  NumberRange range;    // of a number
  double preset = 0.0;  // the default; of a bool: 0 or 1
  double none = 0.0;    // of a radio without impairments
  std::string_view meaning;
};

std::span<const ImpairmentKey> impairment_keys();

Impairments default_impairments();
Impairments no_impairments();

// TOML: the keys that differ from `base`, itself "default" (the default) or "none". Errors name
// file:line:column; unknown keys are errors.
Expected<Impairments> load_impairments(const std::filesystem::path& file);
Expected<Impairments> parse_impairments(std::string_view text, const std::filesystem::path& file);

// The value of a key as it is written in the file: "true", "0.3".
std::string impairment_text(const Impairments& impairments, const ImpairmentKey& key);

// A line a key: its name, default and meaning.
std::string impairments_help();

}  // namespace rayloc
