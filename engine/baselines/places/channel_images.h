// Images of a burst as inputs of the place networks: planes of rows and columns, where a row is a
// frame and a column a tone.
//
// Frames of one burst differ by noise only: several images of a burst are not independent.
#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/baselines/network/network.h"
#include "engine/channel/csi_frame.h"
#include "engine/room/location_estimate.h"
#include "engine/room/room_model.h"

namespace rayloc {

// A frame at one access point, chain gains removed, mean square 1.
struct ImageFrame {
  std::span<const std::complex<double>> h;  // [antenna][tone]
  std::size_t antennas = 0;
  std::size_t tones = 0;
  double spacing = 0.0;  // [wavelengths], from antenna to antenna
};

// Drawing of a frame by a method.
struct ImageKind {
  NetworkKind network = NetworkKind::kLeNet;
  std::size_t (*planes)(std::size_t antennas) = nullptr;                  // a count
  void (*draw)(const ImageFrame& frame, std::span<float> row) = nullptr;  // [plane][tone]
  bool is_standardised = false;  // normalises each plane to mean 0 and deviation 1 over the survey
};

inline constexpr std::size_t kImageRows = 5;  // frames of an image, a count, ours

struct ImageOptions {
  std::size_t count = 16;  // images of a burst [CF]
  std::uint64_t seed = 1;  // for the selection of their frames
};

// For these access points, by number in the room, in this order.
ImageShape image_shape(const RoomModel& room,
                       std::span<const std::size_t> access_points,
                       const ImageKind& kind);

struct BurstImages {
  std::vector<std::vector<float>> images;  // [plane][row][tone] each; empty: no usable frames
  std::vector<bool> received;              // [access point]; planes of absent ones are 0
};

// estimate: receives the numbers of frames and the warnings.
BurstImages burst_images(const RoomModel& room,
                         std::span<const std::size_t> access_points,
                         std::span<const CsiFrame> frames,
                         const ImageKind& kind,
                         const ImageOptions& options,
                         LocationEstimate& estimate);

}  // namespace rayloc
