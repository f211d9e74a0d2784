#include "engine/baselines/dscp/dscp.h"

#include <array>
#include <cmath>
#include <utility>

#include "engine/baselines/places/place_method.h"

namespace rayloc {
namespace {

std::span<const BaselineSetting> dscp_table() {
  // Each states its unit; chosen.
  static const std::array kTable = std::to_array<BaselineSetting>({
      {"cell_m", "cells that merge places [m]; 0: no merging", 0.0, 0.0, 100.0},
      {"images", "images per burst", 16.0, 1.0, 256.0, true},
      {"epochs", "training epochs", 15.0, 1.0, 1000.0, true},
      {"answer", "the place stated", 0.0, 0.0, 0.0, false, place_answers()},
  });
  return kTable;
}

std::size_t all_pairs(std::size_t antennas) {
  return antennas < 2 ? 0 : antennas * (antennas - 1) / 2;
}

void draw_differences(const ImageFrame& frame, std::span<float> row) {
  std::size_t plane = 0;
  for (std::size_t a = 0; a < frame.antennas; ++a) {
    for (std::size_t b = a + 1; b < frame.antennas; ++b, ++plane) {
      for (std::size_t k = 0; k < frame.tones; ++k) {
        row[plane * frame.tones + k] = static_cast<float>(std::abs(frame.h[a * frame.tones + k]) -
                                                          std::abs(frame.h[b * frame.tones + k]));
      }
    }
  }
}

ImageKind dscp_image(const BaselineValues&) {
  return {NetworkKind::kMobileNet, &all_pairs, &draw_differences, true};
}

PlaceMethod dscp_method() { return {"dscp", dscp_table(), "cell_m", &dscp_image, "cell_m"}; }

}  // namespace

std::span<const BaselineSetting> dscp_settings() { return dscp_table(); }

Expected<PlaceClassifier> make_dscp(std::shared_ptr<const RoomModel> room,
                                    const BaselineValues& values,
                                    std::uint64_t seed,
                                    double accuracy_confidence,
                                    std::shared_ptr<const Training> training) {
  return make_classifier(
      dscp_method(), std::move(room), values, seed, accuracy_confidence, std::move(training));
}

Expected<std::shared_ptr<const Training>> train_dscp(const TrainingInput& input) {
  return train_classifier(dscp_method(), input);
}

}  // namespace rayloc
