#include "tests/e2e/device_recording.h"

#include <cstdlib>
#include <fstream>

#include <gtest/gtest.h>

#include "tests/e2e/live_daemon.h"

namespace rayloc::e2e {

std::string recording_of_devices(const std::filesystem::path& folder,
                                 const std::string& access_point,
                                 int first,
                                 int count) {
  constexpr int kRxChains = 3;  // datagrams of a frame, one behind the other
  std::filesystem::path file = folder / ("devices-" + std::to_string(first) + ".pcap");
  const std::string command =
      "gzip -dc '" + bundled_recording("calibration", access_point) + "' >'" + file.string() + "'";
  EXPECT_EQ(std::system(command.c_str()), 0);
  std::string bytes = read_text(file);
  const std::string device("\x02\x52\x4c\x00\x00\x01", 6);
  int datagrams = 0;
  for (std::size_t at = bytes.find(device); at != std::string::npos;
       at = bytes.find(device, at + device.size())) {
    bytes[at + device.size() - 1] = static_cast<char>(first + datagrams / kRxChains % count);
    ++datagrams;
  }
  EXPECT_EQ(datagrams % kRxChains, 0);
  EXPECT_GT(datagrams, kRxChains * count);
  std::ofstream(file, std::ios::binary) << bytes;
  return file.string();
}

}  // namespace rayloc::e2e
