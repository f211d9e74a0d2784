#include "daemon/lab/trace/named_parameters.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>

#include "engine/base/suggestion.h"

namespace rayloc {
namespace {

constexpr int kAllAxes = -1;

using Kind = Parameter::Kind;

struct EndParameter {
  std::string_view name;
  Kind kind;
  int axes;
};
constexpr std::array kEnds = {
    EndParameter{"rx", Kind::kReceiverPosition, 3},
    EndParameter{"tx", Kind::kTransmitterPosition, 3},
    EndParameter{"rx_orientation", Kind::kReceiverOrientation, 3},
    EndParameter{"tx_orientation", Kind::kTransmitterOrientation, 3},
    EndParameter{"rx_array_turn", Kind::kReceiverArrayTurn, 3},
    EndParameter{"tx_array_turn", Kind::kTransmitterArrayTurn, 3},
    EndParameter{"rx_gain", Kind::kReceiverGain, 1},
    EndParameter{"tx_gain", Kind::kTransmitterGain, 1},
};

struct MaterialParameter {
  std::string_view prefix;
  Kind kind;
};
constexpr std::array kMaterials = {
    MaterialParameter{"eps_r.", Kind::kRelativePermittivity},
    MaterialParameter{"sigma.", Kind::kConductivity},
    MaterialParameter{"thickness.", Kind::kThickness},
    MaterialParameter{"scattering.", Kind::kScatteringCoefficient},
};

using Parameters = std::vector<NamedParameter>;

tl::unexpected<Error> refuse(const std::string& what) {
  return make_error(ErrorKind::kUsage, what);
}

// "rx.0" is axis 0 of "rx"; without such a suffix all axes are selected.
std::pair<std::string, int> split_axis(const std::string& word) {
  const std::size_t size = word.size();
  const bool has_axis =
      size > 2 && word[size - 2] == '.' && word[size - 1] >= '0' && word[size - 1] <= '2';
  return has_axis ? std::pair(word.substr(0, size - 2), word[size - 1] - '0')
                  : std::pair(word, kAllAxes);
}

void add_axes(const std::string& name, Parameter parameter, int axis, Parameters& found) {
  for (int i = 0; i < 3; ++i) {
    if (axis == kAllAxes || axis == i) {
      parameter.axis = i;
      found.push_back({name + "." + std::to_string(i), parameter});
    }
  }
}

class GradientParser {
 public:
  explicit GradientParser(const Scene& scene) : scene_(scene) {
    for (const SceneObject& object : scene.objects()) {
      objects_.push_back(object.name);
    }
    for (const RadioMaterial& material : scene.materials()) {
      materials_.push_back(material.name);
    }
  }

  Expected<void> add(const std::string& word, Parameters& found) const {
    const auto [name, axis] = split_axis(word);
    for (const EndParameter& end : kEnds) {
      if (name == end.name && (end.axes == 3 || axis == kAllAxes)) {
        if (end.axes == 3) {
          add_axes(name, {end.kind, 0, 0}, axis, found);
        } else {
          found.push_back({name, {end.kind, 0, 0}});
        }
        return {};
      }
    }
    for (const MaterialParameter& material : kMaterials) {
      if (word.starts_with(material.prefix)) {
        return add_material(material, word, found);
      }
    }
    if (word.starts_with("offset.")) {
      return add_offsets(word, found);
    }
    const std::string object = name.starts_with("object.") ? name.substr(7) : name;
    const auto index = number_of(object, objects_);
    if (!index) {
      std::vector<std::string> known = objects_;
      for (const EndParameter& end : kEnds) {
        known.emplace_back(end.name);
      }
      return refuse("'" + object + "' is no object of the scene, nor rx, tx, " +
                    "rx_orientation, ...; see --help" +
                    suggestion(object, std::span<const std::string>(known)));
    }
    add_axes(object, {Kind::kObjectTranslation, *index, 0}, axis, found);
    return {};
  }

 private:
  static std::optional<std::uint32_t> number_of(const std::string& name,
                                                const std::vector<std::string>& names) {
    for (std::uint32_t i = 0; i < names.size(); ++i) {
      if (names[i] == name) {
        return i;
      }
    }
    return std::nullopt;
  }

  Expected<void> add_material(const MaterialParameter& parameter,
                              const std::string& word,
                              Parameters& found) const {
    const std::string name = word.substr(parameter.prefix.size());
    const auto index = number_of(name, materials_);
    if (!index) {
      return refuse("the scene has no material '" + name + "'" +
                    suggestion(name, std::span<const std::string>(materials_)));
    }
    found.push_back({word, {parameter.kind, *index, 0}});
    return {};
  }

  Expected<void> add_offsets(const std::string& word, Parameters& found) const {
    const std::string name = word.substr(std::string_view("offset.").size());
    const auto object = number_of(name, objects_);
    if (!object) {
      return refuse("the scene has no object '" + name + "'" +
                    suggestion(name, std::span<const std::string>(objects_)));
    }
    int number = 0;
    for (std::uint32_t i = 0; i < scene_.surfaces().size(); ++i) {
      if (scene_.owner(i).object == *object) {
        found.push_back({word + "." + std::to_string(number++), Parameter::surface_offset(i)});
      }
    }
    return {};
  }

  const Scene& scene_;
  std::vector<std::string> objects_;
  std::vector<std::string> materials_;
};

}  // namespace

Expected<std::vector<NamedParameter>> parse_parameters(const std::string& names,
                                                       const Scene& scene) {
  const GradientParser parser(scene);
  Parameters found;
  for (std::size_t begin = 0; begin <= names.size();) {
    const std::size_t end = std::min(names.find(',', begin), names.size());
    RAYLOC_TRY(parser.add(names.substr(begin, end - begin), found));
    begin = end + 1;
  }
  return found;
}

}  // namespace rayloc
