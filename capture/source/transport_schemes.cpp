#include "capture/source/transport_schemes.h"

#include <array>

namespace rayloc {

TransportTable transport_schemes() {
  static const std::array kTable{kUdpScheme, kPcapScheme, kUnixScheme, kLiveScheme};
  return kTable;
}

}  // namespace rayloc
