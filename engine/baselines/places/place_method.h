// A method that is a classifier of places (place_classifier.h), defined by its settings and its
// images.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

#include "engine/base/expected.h"
#include "engine/baselines/places/place_classifier.h"
#include "engine/baselines/settings.h"
#include "engine/baselines/training.h"

namespace rayloc {

// Two words of a setting "answer": "mean", PlaceAnswer::is_heaviest false, and "best".
std::span<const std::string_view> place_answers();

struct PlaceMethod {
  std::string_view name;
  // Contains "images", "epochs" and "answer", and the key below.
  std::span<const BaselineSetting> settings;
  std::string_view learned;  // a key: its value at training also applies to localization
  ImageKind (*kind)(const BaselineValues& values) = nullptr;
  std::string_view cell = {};  // a key: PlaceTrainingOptions::cell; empty: no merging
};

// Errors: as of PlaceClassifier, and if `values` states another `learned` than the training.
Expected<PlaceClassifier> make_classifier(const PlaceMethod& method,
                                          std::shared_ptr<const RoomModel> room,
                                          const BaselineValues& values,
                                          std::uint64_t seed,
                                          double accuracy_confidence,
                                          std::shared_ptr<const Training> training);

Expected<std::shared_ptr<const Training>> train_classifier(const PlaceMethod& method,
                                                           const TrainingInput& input);

}  // namespace rayloc
