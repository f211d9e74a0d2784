#include "daemon/live/service/site/privacy.h"

#include <utility>

#include "daemon/live/log/log.h"

namespace rayloc {

Expected<std::shared_ptr<TargetNames>> open_target_names(const DaemonConfig& config) {
  TargetNames::Options options;
  options.hashed = config.privacy.target_id == TargetId::kHmac;
  options.period = config.privacy.rotate;
  if (options.hashed && !config.privacy.key_file.empty()) {
    Expected<std::string> key = TargetNames::read_key(config.privacy.key_file);
    RAYLOC_TRY(key);
    options.key = std::move(*key);
  }
  if (options.hashed && !config.record.directory.empty()) {
    log_event({LogLevel::kWarning,
               "[privacy] hashes what is published, but recordings hold the addresses of all "
               "devices: keep them as secret as those, or leave [record] out"});
  }
  return std::make_shared<TargetNames>(std::move(options));
}

std::string transmitter_name(const Site& site, const CsiFrame& frame, TargetNames& names) {
  const SiteTransmitter* fixed = find_fixed_transmitter(site, frame.transmitter);
  return names.hashed() && fixed != nullptr && !fixed->name.empty()
             ? fixed->name
             : names.text(frame.transmitter, frame.time);
}

}  // namespace rayloc
