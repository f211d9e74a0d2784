// Impairments: effects of an access point's radio between the channel at its antennas and the
// reported CSI. Values are in the units of the file, as in their names.
//
// A value of zero (or false) switches an impairment off; with all of them off, the losses of the
// format remain: mantissas of 11 bits and power in whole dBm. The defaults are those measured on
// recordings of bcm43684 (AX-CSI) or, without a recording, those of the project's datasets.
//
// impairment_keys() defines the file's keys completely: reading, defaults and the text of `rayloc
// simulate --help` come from it, and a row stores its value.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "daemon/site/model/number_range.h"
#include "engine/base/expected.h"

namespace rayloc {

struct Impairments {
  // In every frame.
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
  // At a power cycle.
  bool calibrated_chains = false;
  double chain_gain_db = 0.0;
  double chain_phase_deg = 0.0;
  double chain_delay_ns = 0.0;
  double ripple_db = 0.0;
  double ripple_deg = 0.0;
  double coupling_db = 0.0;
  double image_rejection_db = 0.0;
  // In the traffic.
  double retry_share = 0.0;
  double loss_share = 0.0;
  double transmit_power_dbm = 0.0;
};

struct ImpairmentKey {
  std::string_view key;
  std::variant<bool Impairments::*, double Impairments::*> member;
  NumberRange range;    // for a number
  double preset = 0.0;  // the default; for a bool: 0 or 1
  double none = 0.0;    // for a radio without impairments
  std::string_view meaning;
};

std::span<const ImpairmentKey> impairment_keys();

Impairments default_impairments();
Impairments no_impairments();

// TOML: the keys that differ from `base`, itself "default" (the default) or "none". Errors name
// file:line:column; unknown keys are errors.
Expected<Impairments> load_impairments(const std::filesystem::path& file);
Expected<Impairments> parse_impairments(std::string_view text, const std::filesystem::path& file);

// The value of a key in the file's syntax: "true", "0.3".
std::string impairment_text(const Impairments& impairments, const ImpairmentKey& key);

// One line per key: its name, default and meaning.
std::string impairments_help();

}  // namespace rayloc
