#include "engine/scene/read/xml_element.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "engine/base/number_text.h"
#include "engine/base/suggestion.h"

namespace rayloc {
namespace {

// Elements that are a value of the enclosing element.
constexpr std::array<std::string_view, 10> kPropertyTags{"float",
                                                         "integer",
                                                         "string",
                                                         "boolean",
                                                         "rgb",
                                                         "spectrum",
                                                         "point",
                                                         "vector",
                                                         "transform",
                                                         "color"};

// Mitsuba's tags within a transform.
constexpr std::array<std::string_view, 5> kTransformSteps{
    "translate", "rotate", "scale", "matrix", "lookat"};

template <typename Container>
bool has(const Container& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string tag_of(const pugi::xml_node& node) {
  const std::string_view name = node.attribute("name").value();
  std::string tag = "<" + std::string(node.name());
  if (!name.empty()) {
    tag += " name=\"" + std::string(name) + "\"";
  }
  return tag + ">";
}

std::string meant(std::string_view word, const std::vector<std::string_view>& names) {
  return suggestion(word, std::span<const std::string_view>(names));
}

}  // namespace

std::optional<double> parse_number(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\n";  // the blanks of XML
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) {
    return std::nullopt;
  }
  text = text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
  const std::optional<double> value = read_number(text);
  if (!value || !text.empty() || !std::isfinite(*value)) {
    return std::nullopt;
  }
  return value;
}

std::optional<std::vector<double>> parse_numbers(std::string_view text) {
  // Blanks of XML, and commas: Mitsuba accepts both.
  constexpr std::string_view kSeparators = " \t\r\n,";
  std::vector<double> numbers;
  for (std::size_t begin = text.find_first_not_of(kSeparators); begin != std::string_view::npos;) {
    const std::size_t end = std::min(text.find_first_of(kSeparators, begin), text.size());
    const auto value = parse_number(text.substr(begin, end - begin));
    if (!value) {
      return std::nullopt;
    }
    numbers.push_back(*value);
    begin = text.find_first_not_of(kSeparators, end);
  }
  return numbers;
}

XmlElement::XmlElement(XmlFile& file, const pugi::xml_node& node, std::string name)
    : file_(file), node_(node), name_(std::move(name)) {}

std::string XmlElement::attribute(std::string_view name) {
  attributes_.push_back(name);
  return node_.attribute(std::string(name).c_str()).value();
}

bool XmlElement::has_attribute(std::string_view name) const {
  return !node_.attribute(std::string(name).c_str()).empty();
}

pugi::xml_node XmlElement::property(std::string_view tag, std::string_view name) {
  properties_.emplace_back(name, tag);
  pugi::xml_node found;
  for (const pugi::xml_node& child : node_.children()) {
    if (child.name() != tag || child.attribute("name").value() != name) {
      continue;
    }
    if (found) {
      file_.complain(child, tag_of(child) + of_this() + " is stated twice");
    } else {
      found = child;
    }
  }
  return found;
}

std::optional<double> XmlElement::number(std::string_view name, std::string_view tag) {
  const pugi::xml_node child = property(tag, name);
  if (!child) {
    return std::nullopt;
  }
  const auto value = parse_number(child.attribute("value").value());
  if (!value) {
    file_.complain(child,
                   "'" + std::string(name) + "' must be a number, not '" +
                       child.attribute("value").value() + "'");
  }
  return value;
}

std::optional<double> XmlElement::whole_or_number(std::string_view name) {
  const std::optional<double> value = number(name);
  const std::optional<double> whole = number(name, "integer");
  return value ? value : whole;
}

std::optional<std::string> XmlElement::text(std::string_view name) {
  const pugi::xml_node child = property("string", name);
  if (!child) {
    return std::nullopt;
  }
  std::string value = child.attribute("value").value();
  if (value.empty()) {
    file_.complain(child, tag_of(child) + of_this() + " has no value");
    return std::nullopt;
  }
  return value;
}

void XmlElement::refuse(std::string_view name, const std::string& why) {
  for (const pugi::xml_node& child : node_.children()) {
    if (child.attribute("name").value() == name) {
      file_.complain(child, tag_of(child) + of_this() + " " + why);
    }
  }
}

void XmlElement::allow_tags(std::initializer_list<std::string_view> tags) {
  tags_.insert(tags_.end(), tags.begin(), tags.end());
}

void XmlElement::allow_tags(std::span<const std::string_view> tags) {
  tags_.insert(tags_.end(), tags.begin(), tags.end());
}

void XmlElement::finish() {
  for (const pugi::xml_attribute& attribute : node_.attributes()) {
    if (file_.listens() && !has(attributes_, attribute.name())) {
      file_.complain(node_,
                     "the attribute '" + std::string(attribute.name()) + "' of <" + node_.name() +
                         "> is not read" + meant(attribute.name(), attributes_));
    }
  }
  for (const pugi::xml_node& child : node_.children()) {
    if (file_.listens()) {
      check_child(child);
    }
  }
}

void XmlElement::check_child(const pugi::xml_node& child) {
  if (child.type() == pugi::node_pcdata || child.type() == pugi::node_cdata) {
    file_.complain(child,
                   "text within <" + std::string(node_.name()) +
                       "> is not read; a value is written as value=\"...\"");
    return;
  }
  if (child.type() != pugi::node_element || all_tags_) {
    return;
  }
  const std::string_view tag = child.name();
  const std::string_view name = child.attribute("name").value();
  auto known = std::find(properties_.begin(), properties_.end(), std::pair(name, tag));
  if (known == properties_.end()) {
    known = std::find_if(
        properties_.begin(), properties_.end(), [&](const auto& one) { return one.first == name; });
  }
  if (known != properties_.end() && known->second != tag) {
    file_.complain(child,
                   tag_of(child) + of_this() + " is not read; write <" +
                       std::string(known->second) + " name=\"" + std::string(name) + "\">");
  } else if (known != properties_.end() && tag != "transform") {
    check_property(child);
  } else if (known == properties_.end() && !has(tags_, tag)) {
    const bool is_property = has(kPropertyTags, tag);
    if (!is_property || is_left_out_ == nullptr || !is_left_out_(name)) {
      file_.complain(child,
                     tag_of(child) + of_this() + " is not read" +
                         (is_property ? meant_by_property(tag, name) : meant_by_tag(tag)));
    }
  }
}

std::string XmlElement::meant_by_property(std::string_view tag, std::string_view name) const {
  std::vector<std::string_view> names;
  for (const auto& [property, of_tag] : properties_) {
    if (!name.empty() || of_tag == tag) {
      names.push_back(property);
    }
  }
  return (name.empty() ? "; it has no name" : "") + meant(name, names);
}

std::string XmlElement::meant_by_tag(std::string_view tag) const {
  if (has(kTransformSteps, tag)) {
    return "; it belongs into a <transform name=\"to_world\">";
  }
  std::vector<std::string_view> known = tags_;
  known.insert(known.end(), kPropertyTags.begin(), kPropertyTags.end());
  const std::string_view close = closest_name(tag, known);
  return close.empty() ? "" : "; did you mean <" + std::string(close) + ">?";
}

void XmlElement::check_property(const pugi::xml_node& child) {
  XmlElement property(file_, child, {});
  property.attribute("name");
  property.attribute("value");
  property.finish();
}

}  // namespace rayloc
