// Images of a burst, as networks that know places are shown them: planes of rows and columns, where
// a row is a frame and a column a tone.
//
// Frames of one burst differ by noise alone: several images of a burst are no several measurements.
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

// How a method draws a frame.
struct ImageKind {
  NetworkKind network = NetworkKind::kLeNet;
  std::size_t (*planes)(std::size_t antennas) = nullptr;                  // a count
  void (*draw)(const ImageFrame& frame, std::span<float> row) = nullptr;  // [plane][tone]
  bool is_standardised = false;  // each plane to mean 0 and deviation 1 of the survey
};

inline constexpr std::size_t kImageRows = 5;  // frames of an image, a count, ours

struct ImageOptions {
  std::size_t count = 16;  // images of a burst [CF]
  std::uint64_t seed = 1;  // of the draw of their frames
};

// Of the access points by number in the room, in this order.
ImageShape image_shape(const RoomModel& room,
                       std::span<const std::size_t> access_points,
                       const ImageKind& kind);

struct BurstImages {
  std::vector<std::vector<float>> images;  // [plane][row][tone] each; empty: nothing was heard
  std::vector<bool> heard;                 // of each access point; planes of others are 0
};

// Estimate: what was heard goes into its numbers, what was wrong into its warnings.
BurstImages burst_images(const RoomModel& room,
                         std::span<const std::size_t> access_points,
                         std::span<const CsiFrame> frames,
                         const ImageKind& kind,
                         const ImageOptions& options,
                         LocationEstimate& estimate);

}  // namespace rayloc
