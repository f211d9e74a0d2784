#include "daemon/lab/simulate/impairments.h"

#include <array>
#include <memory>
#include <utility>

#include "daemon/site/model/toml_reader.h"

namespace rayloc {
namespace {

using I = Impairments;

constexpr NumberRange kShare = {0.0, 1.0, {}};
constexpr NumberRange kDelay = {0.0, 3'000.0, "ns"};  // a tone spacing of 312.5 kHz is 3.2 us
constexpr NumberRange kDecibels = {0.0, 60.0, "dB"};
constexpr NumberRange kPhaseDegrees = {0.0, 180.0, "degrees"};

constexpr std::array kImpairmentKeys = std::to_array<ImpairmentKey>({
    {"random_phase", &I::random_phase, {}, 1, 0, "common phase, drawn for each frame"},
    {"delay_min_ns", &I::delay_min_ns, kDelay, 60, 0, "minimum timing offset of a frame"},
    {"delay_max_ns", &I::delay_max_ns, kDelay, 350, 0, "maximum timing offset of a frame"},
    {"delay_outlier_share",
     &I::delay_outlier_share,
     kShare,
     0.02,
     0,
     "share of frames with an additional delay"},
    {"delay_outlier_ns", &I::delay_outlier_ns, kDelay, 200, 0, "additional delay of these frames"},
    {"gain_step_db",
     &I::gain_step_db,
     kDecibels,
     3,
     0,
     "step of the gain control, common to all chains"},
    {"power_error_db", &I::power_error_db, kDecibels, 1, 0, "maximum error of a power byte"},
    {"phase_jitter_deg",
     &I::phase_jitter_deg,
     kPhaseDegrees,
     2,
     0,
     "standard deviation of the phase between two chains"},
    {"snr_db", &I::snr_db, kDecibels, 31, 0, "SNR at 4 m in free space, half-wave dipoles"},
    {"transmit_snr_db",
     &I::transmit_snr_db,
     kDecibels,
     38,
     0,
     "ratio of the signal to the transmitter's error"},
    {"dc_garbage", &I::dc_garbage, {}, 1, 0, "a meaningless value at DC, as large as the data"},
    {"calibrated_chains",
     &I::calibrated_chains,
     {},
     1,
     0,
     "chains of the site's calibration, where it has them; otherwise drawn:"},
    {"chain_gain_db", &I::chain_gain_db, kDecibels, 1, 0, "standard deviation of a chain's gain"},
    {"chain_phase_deg", &I::chain_phase_deg, kPhaseDegrees, 180, 0, "maximum phase of a chain"},
    {"chain_delay_ns",
     &I::chain_delay_ns,
     {0.0, 10.0, "ns"},
     0,
     0,
     "standard deviation of a chain's cable delay; the phase therefore differs between channels"},
    {"ripple_db",
     &I::ripple_db,
     kDecibels,
     0.3,
     0,
     "amplitude of a chain's gain ripple over the band"},
    {"ripple_deg",
     &I::ripple_deg,
     kPhaseDegrees,
     2,
     0,
     "amplitude of a chain's phase ripple over the band"},
    {"coupling_db",
     &I::coupling_db,
     kDecibels,
     28,
     0,
     "antenna coupling, below the antenna's own signal"},
    {"image_rejection_db", &I::image_rejection_db, kDecibels, 33, 0, "rejection of the image tone"},
    {"retry_share",
     &I::retry_share,
     kShare,
     0.08,
     0,
     "share of frames that repeat the 802.11 sequence number of the previous frame"},
    {"loss_share", &I::loss_share, kShare, 0, 0, "share of datagrams that are lost"},
    {"transmit_power_dbm",
     &I::transmit_power_dbm,
     {-30.0, 36.0, "dBm"},
     12,
     12,
     "transmit power of the device, for the power bytes"},
});

Impairments impairments_from(double ImpairmentKey::*column) {
  Impairments values;
  for (const ImpairmentKey& key : kImpairmentKeys) {
    if (const auto* flag = std::get_if<bool Impairments::*>(&key.member)) {
      values.** flag = key.*column != 0.0;
    } else {
      values.*std::get<double Impairments::*>(key.member) = key.*column;
    }
  }
  return values;
}

Expected<Impairments> read_impairment_keys(TomlDocument& document) {
  static constexpr std::array<std::string_view, 2> kBases = {"default", "none"};
  const TomlTable root = document.root();
  Impairments values = root.choice("base", kBases).value_or("default") == "none"
                           ? no_impairments()
                           : default_impairments();
  for (const ImpairmentKey& key : kImpairmentKeys) {
    if (const auto* flag = std::get_if<bool Impairments::*>(&key.member)) {
      values.** flag = root.boolean(key.key).value_or(values.**flag);
    } else {
      double& number = values.*std::get<double Impairments::*>(key.member);
      number = root.number(key.key, key.range).value_or(number);
    }
  }
  if (values.delay_max_ns < values.delay_min_ns) {
    root.error_at("delay_max_ns",
                  "'delay_max_ns' is " + to_text(values.delay_max_ns) + ", less than " +
                      to_text(values.delay_min_ns) + ", the 'delay_min_ns'; exchange them");
  }
  RAYLOC_TRY(document.finish());
  return values;
}

}  // namespace

std::span<const ImpairmentKey> impairment_keys() { return kImpairmentKeys; }

Impairments default_impairments() { return impairments_from(&ImpairmentKey::preset); }
Impairments no_impairments() { return impairments_from(&ImpairmentKey::none); }

Expected<Impairments> load_impairments(const std::filesystem::path& file) {
  auto document = TomlDocument::read(file);
  return document ? read_impairment_keys(**document)
                  : tl::make_unexpected(std::move(document.error()));
}

Expected<Impairments> parse_impairments(std::string_view text, const std::filesystem::path& file) {
  auto document = TomlDocument::parse(text, file);
  return document ? read_impairment_keys(**document)
                  : tl::make_unexpected(std::move(document.error()));
}

std::string impairment_text(const Impairments& impairments, const ImpairmentKey& key) {
  if (const auto* flag = std::get_if<bool Impairments::*>(&key.member)) {
    return impairments.**flag ? "true" : "false";
  }
  return to_text(impairments.*std::get<double Impairments::*>(key.member));
}

std::string impairments_help() {
  constexpr std::size_t kWidth = 28;  // width of "delay_outlier_share = 0.02"
  std::string text;
  for (const ImpairmentKey& key : kImpairmentKeys) {
    std::string line = std::string(key.key) + " = " + impairment_text(default_impairments(), key);
    line.resize(std::max(line.size(), kWidth), ' ');
    text += line + "# " + std::string(key.meaning) + "\n";
  }
  return text;
}

}  // namespace rayloc
