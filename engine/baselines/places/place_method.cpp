#include "engine/baselines/places/place_method.h"

#include <array>
#include <string>
#include <utility>

namespace rayloc {
namespace {

// The given values, with that of PlaceMethod::learned taken from the training. An Error (kUsage) if
// a different value is given.
Expected<BaselineValues> with_learned_value(const PlaceMethod& method,
                                            const BaselineValues& given,
                                            const Training* training) {
  BaselineValues all = given;
  if (training == nullptr) {
    return all;
  }
  const std::string key(method.learned);
  const std::string before = setting_text(method.settings, training->values, key);
  const std::string now = setting_text(method.settings, given, key);
  if (given.contains(key) && now != before) {
    return make_error(ErrorKind::kUsage,
                      "--baseline " + key + "=" + now + ": trained with " + key + "=" + before +
                          "; leave it out, or train again (rayloc train)");
  }
  if (const auto kept = training->values.find(key); kept != training->values.end()) {
    all.insert_or_assign(key, kept->second);
  }
  return all;
}

PlaceClassifierOptions options_of(const PlaceMethod& method,
                                  const BaselineValues& values,
                                  std::uint64_t seed) {
  PlaceClassifierOptions options;
  options.method = method.name;
  options.kind = method.kind(values);
  options.images = static_cast<std::size_t>(number_of(method.settings, values, "images"));
  options.seed = seed;
  options.answer.is_heaviest = choice_of(method.settings, values, "answer") == 1;
  return options;
}

}  // namespace

std::span<const std::string_view> place_answers() {
  // Two words: the reported place.
  static constexpr std::array kAnswers = std::to_array<std::string_view>({"mean", "best"});
  return kAnswers;
}

Expected<PlaceClassifier> make_classifier(const PlaceMethod& method,
                                          std::shared_ptr<const RoomModel> room,
                                          const BaselineValues& values,
                                          std::uint64_t seed,
                                          double accuracy_confidence,
                                          std::shared_ptr<const Training> training) {
  auto all = with_learned_value(method, values, training.get());
  RAYLOC_TRY(all);
  PlaceClassifierOptions options = options_of(method, *all, seed);
  options.answer.accuracy_confidence = accuracy_confidence;
  return PlaceClassifier::create(std::move(room), options, std::move(training));
}

Expected<std::shared_ptr<const Training>> train_classifier(const PlaceMethod& method,
                                                           const TrainingInput& input) {
  PlaceTrainingOptions options;
  options.classifier = options_of(method, input.values, input.seed);
  options.epochs = static_cast<std::size_t>(number_of(method.settings, input.values, "epochs"));
  if (!method.cell.empty()) {
    options.cell = number_of(method.settings, input.values, method.cell);
  }
  return train_places(input, options);
}

}  // namespace rayloc
