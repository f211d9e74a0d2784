#include "capture/source/source_advice.h"

namespace rayloc {

std::string_view source_advice(std::string_view reason) {
  if (reason == "other_channel") {
    return "set the access point to the site's channel, or state its channel in site.toml "
           "([carrier] "
           "channel, bandwidth_mhz, centre_hz) and calibrate on it";
  }
  if (reason == "several_access_points") {
    return "send the CSI of each access point to a port of its own, or restrict each [[source]] to "
           "one "
           "sender with allow; split a recording by sender (tcpdump -r FILE src host ADDRESS)";
  }
  return "";
}

}  // namespace rayloc
