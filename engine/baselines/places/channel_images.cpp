#include "engine/baselines/places/channel_images.h"

#include <algorithm>
#include <random>

#include "engine/base/constants.h"
#include "engine/room/preprocess_burst.h"

namespace rayloc {
namespace {

constexpr std::size_t kMaxFrames = 64;  // limit of a burst at an access point, a count, chosen

// The planes of each frame of an access point: [frame][plane][tone].
std::vector<std::vector<float>> rows_of(const RoomModel& room,
                                        std::size_t access_point,
                                        std::span<const CsiFrame> frames,
                                        const ImageKind& kind) {
  const RoomAccessPoint& ap = room.access_points[access_point];
  const double wavelength = kSpeedOfLight / room.grid.centre_hz;
  const double spacing =
      ap.array.element_offset.size() < 2
          ? 0.0
          : norm(element_position(ap.array, 1) - element_position(ap.array, 0)) / wavelength;
  std::vector<std::vector<float>> rows;
  std::vector<std::string> of_single_frames;  // already reported for the burst
  for (const CsiFrame& frame : frames) {
    if (frame.access_point != access_point || rows.size() == kMaxFrames) {
      continue;
    }
    const auto one = preprocess_burst(room, access_point, {&frame, 1}, {}, of_single_frames);
    if (one) {
      std::vector<float>& row =
          rows.emplace_back(kind.planes(ap.rx_chains.size()) * room.grid.size());
      kind.draw({one->h, ap.rx_chains.size(), room.grid.size(), spacing}, row);
    }
  }
  return rows;
}

}  // namespace

ImageShape image_shape(const RoomModel& room,
                       std::span<const std::size_t> access_points,
                       const ImageKind& kind) {
  ImageShape shape{0, kImageRows, room.grid.size()};
  for (const std::size_t i : access_points) {
    shape.channels += kind.planes(room.access_points[i].rx_chains.size());
  }
  return shape;
}

BurstImages burst_images(const RoomModel& room,
                         std::span<const std::size_t> access_points,
                         std::span<const CsiFrame> frames,
                         const ImageKind& kind,
                         const ImageOptions& options,
                         LocationEstimate& estimate) {
  const ImageShape shape = image_shape(room, access_points, kind);
  BurstImages result;
  ObservationTally tally;
  std::mt19937_64 random(options.seed);
  std::size_t first_plane = 0;
  for (const std::size_t i : access_points) {
    const RoomAccessPoint& ap = room.access_points[i];
    const std::size_t planes = kind.planes(ap.rx_chains.size());
    const auto burst = preprocess_burst(room, i, frames, {}, estimate.warnings);
    const auto rows = burst ? rows_of(room, i, frames, kind) : std::vector<std::vector<float>>();
    result.received.push_back(!rows.empty());
    if (!rows.empty()) {
      tally.add(ap, *burst);
      result.images.resize(options.count, std::vector<float>(shape.size()));
      for (std::vector<float>& image : result.images) {
        for (std::size_t r = 0; r < shape.rows; ++r) {
          const std::vector<float>& row = rows[random() % rows.size()];
          for (std::size_t p = 0; p < planes; ++p) {
            std::copy_n(row.data() + p * shape.columns,
                        shape.columns,
                        image.data() + ((first_plane + p) * shape.rows + r) * shape.columns);
          }
        }
      }
    }
    first_plane += planes;
  }
  if (!frames.empty()) {
    tally.fill(frames, estimate);
  }
  return result;
}

}  // namespace rayloc
