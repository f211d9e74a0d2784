#include "engine/scene/read/xml_defaults.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/suggestion.h"
#include "engine/scene/read/xml_element.h"

namespace rayloc {
namespace {

// A few lines of <default>s that refer to each other must not become gigabytes.
constexpr std::size_t kLongestValue = 1024;

using Defaults = std::map<std::string, std::string>;

class Replacement : public pugi::xml_tree_walker {
 public:
  Replacement(XmlFile& file, const Defaults& defaults) : file_(file), defaults_(defaults) {}

  void replace_in(pugi::xml_node& node) {
    for (pugi::xml_attribute& attribute : node.attributes()) {
      const std::string_view text = attribute.value();
      if (text.find('$') != std::string_view::npos) {
        attribute.set_value(replaced(text, node).c_str());
      }
    }
  }

  bool for_each(pugi::xml_node& node) override {
    replace_in(node);
    return true;
  }

 private:
  // The longest name at the beginning of `text`: "$height" is not "$h" and "eight".
  Defaults::const_iterator longest_name(std::string_view text) const {
    auto best = defaults_.end();
    for (auto it = defaults_.begin(); it != defaults_.end(); ++it) {
      if (text.substr(0, it->first.size()) == it->first &&
          (best == defaults_.end() || it->first.size() > best->first.size())) {
        best = it;
      }
    }
    return best;
  }

  std::string replaced(std::string_view text, const pugi::xml_node& node) {
    std::string result;
    for (std::size_t at = 0; at < text.size();) {
      if (text[at] != '$') {
        result += text[at++];
        continue;
      }
      const auto known = longest_name(text.substr(at + 1));
      if (known == defaults_.end()) {
        complain(text.substr(at + 1), node);
        return std::string(text);
      }
      result += known->second;
      at += 1 + known->first.size();
      if (result.size() > kLongestValue) {
        file_.complain(node, "a value with its <default>s is longer than 1024 letters");
        return {};
      }
    }
    return result;
  }

  void complain(std::string_view name, const pugi::xml_node& node) {
    if (file_.listens()) {
      std::vector<std::string> names;
      for (const auto& [known, value] : defaults_) {
        names.push_back(known);
      }
      file_.complain(node,
                     "there is no <default> for '$" + std::string(name) + "' before this" +
                         suggestion(name, names));
    }
  }

  XmlFile& file_;
  const Defaults& defaults_;
};

}  // namespace

void apply_defaults(XmlFile& file, const pugi::xml_node& scene) {
  Defaults defaults;
  Replacement replacement(file, defaults);
  for (pugi::xml_node node : scene.children()) {
    const std::string_view tag = node.name();
    if (tag == "default") {
      if (!defaults.empty()) {
        replacement.replace_in(node);
      }
      XmlElement element(file, node, {});
      const std::string name = element.attribute("name");
      if (name.empty()) {
        element.complain("a <default> needs a name and a value");
      } else {
        defaults.emplace(name, element.attribute("value"));
      }
      element.finish();
    } else if ((tag == "bsdf" || tag == "shape") && !defaults.empty()) {
      replacement.replace_in(node);
      node.traverse(replacement);
    }
  }
}

}  // namespace rayloc
