// The bundled calibration as other devices would have sent it.
#pragma once

#include <filesystem>
#include <string>

namespace rayloc::e2e {

// The calibration of `access_point`, frame by frame from one of `count` devices in turn, whose
// addresses are 02:52:4c:00:00:FIRST and those behind it; uncompressed, in `folder`.
std::string recording_of_devices(const std::filesystem::path& folder,
                                 const std::string& access_point,
                                 int first,
                                 int count);

}  // namespace rayloc::e2e
