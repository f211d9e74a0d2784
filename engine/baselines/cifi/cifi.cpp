#include "engine/baselines/cifi/cifi.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "engine/baselines/places/place_method.h"

namespace rayloc {
namespace {

// Two words: the content of an image.
constexpr std::array kInputs = std::to_array<std::string_view>({"phase", "aoa"});

std::span<const BaselineSetting> cifi_table() {
  // Each states its unit; 16 images are the paper's, the others chosen.
  static const std::array kTable = std::to_array<BaselineSetting>({
      {"input", "content of an image", 0.0, 0.0, 0.0, false, kInputs},
      {"images", "images per burst", 16.0, 1.0, 256.0, true},
      {"epochs", "training epochs", 15.0, 1.0, 1000.0, true},
      {"answer", "the place stated", 0.0, 0.0, 0.0, false, place_answers()},
  });
  return kTable;
}

std::size_t neighbour_pairs(std::size_t antennas) {
  return antennas - std::min<std::size_t>(1, antennas);
}

// The phase difference from antenna `pair` to the next.
double phase(const ImageFrame& frame, std::size_t pair, std::size_t tone) {
  return std::arg(frame.h[(pair + 1) * frame.tones + tone] *
                  std::conj(frame.h[pair * frame.tones + tone]));
}

std::size_t phase_planes(std::size_t antennas) { return 2 * neighbour_pairs(antennas); }

void draw_phases(const ImageFrame& frame, std::span<float> row) {
  for (std::size_t pair = 0; pair < neighbour_pairs(frame.antennas); ++pair) {
    for (std::size_t k = 0; k < frame.tones; ++k) {
      const double turn = phase(frame, pair, k);
      row[2 * pair * frame.tones + k] = static_cast<float>(std::cos(turn));
      row[(2 * pair + 1) * frame.tones + k] = static_cast<float>(std::sin(turn));
    }
  }
}

void draw_angles(const ImageFrame& frame, std::span<float> row) {
  for (std::size_t pair = 0; pair < neighbour_pairs(frame.antennas); ++pair) {
    for (std::size_t k = 0; k < frame.tones; ++k) {
      const double sine = phase(frame, pair, k) / (2.0 * std::numbers::pi * frame.spacing);
      row[pair * frame.tones + k] = static_cast<float>(std::asin(std::clamp(sine, -1.0, 1.0)));
    }
  }
}

ImageKind cifi_image(const BaselineValues& values) {
  const bool is_published = choice_of(cifi_table(), values, "input") == 1;
  return is_published ? ImageKind{NetworkKind::kLeNet, &neighbour_pairs, &draw_angles, false}
                      : ImageKind{NetworkKind::kLeNet, &phase_planes, &draw_phases, false};
}

PlaceMethod cifi_method() { return {"cifi", cifi_table(), "input", &cifi_image}; }

}  // namespace

std::span<const BaselineSetting> cifi_settings() { return cifi_table(); }

Expected<PlaceClassifier> make_cifi(std::shared_ptr<const RoomModel> room,
                                    const BaselineValues& values,
                                    std::uint64_t seed,
                                    double accuracy_confidence,
                                    std::shared_ptr<const Training> training) {
  return make_classifier(
      cifi_method(), std::move(room), values, seed, accuracy_confidence, std::move(training));
}

Expected<std::shared_ptr<const Training>> train_cifi(const TrainingInput& input) {
  return train_classifier(cifi_method(), input);
}

}  // namespace rayloc
