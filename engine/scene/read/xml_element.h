// XmlElement: one element of a scene file, read property by property. finish() reports all parts
// that were never requested. Internal to load_scene.
//
// A property is <TAG name="NAME" value="..."/>: <float> or <string>.
#pragma once

#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <pugixml.hpp>

#include "engine/scene/read/xml_file.h"

namespace rayloc {

// One finite number, with only blanks around it.
std::optional<double> parse_number(std::string_view text);
// Numbers separated by blanks or commas; nothing when the text contains anything else.
std::optional<std::vector<double>> parse_numbers(std::string_view text);

class XmlElement {
 public:
  // `name` is for messages: "shape 'wall'". All views must outlive the element.
  XmlElement(XmlFile& file, const pugi::xml_node& node, std::string name);

  // "" when it is absent.
  std::string attribute(std::string_view name);
  bool has_attribute(std::string_view name) const;

  // The child of that tag and name; a second one is reported.
  pugi::xml_node property(std::string_view tag, std::string_view name);
  // Report a fault where the value is missing or invalid.
  std::optional<double> number(std::string_view name, std::string_view tag = "float");
  // The same, written as <float> or as <integer>.
  std::optional<double> whole_or_number(std::string_view name);
  std::optional<std::string> text(std::string_view name);
  // Reports a fault where the property is present.
  void refuse(std::string_view name, const std::string& why);

  // Children of these tags are read by other code, or left out knowingly, with any name.
  void allow_tags(std::initializer_list<std::string_view> tags);
  void allow_tags(std::span<const std::string_view> tags);
  void allow_all_tags() { all_tags_ = true; }
  // Properties that are left out knowingly: `is_left_out` tests a name.
  void leave_out(bool (*is_left_out)(std::string_view name)) { is_left_out_ = is_left_out; }

  void complain(const std::string& what) { file_.complain(node_, what); }
  // Reports every attribute, property, other child and text that was not requested.
  void finish();

 private:
  void check_child(const pugi::xml_node& child);
  std::string meant_by_property(std::string_view tag, std::string_view name) const;
  std::string meant_by_tag(std::string_view tag) const;
  void check_property(const pugi::xml_node& child);
  std::string of_this() const { return name_.empty() ? "" : " of the " + name_; }

  XmlFile& file_;
  pugi::xml_node node_;
  std::string name_;
  std::vector<std::string_view> attributes_;                               // requested
  std::vector<std::pair<std::string_view, std::string_view>> properties_;  // name, tag
  std::vector<std::string_view> tags_;
  bool all_tags_ = false;
  bool (*is_left_out_)(std::string_view name) = nullptr;
};

}  // namespace rayloc
