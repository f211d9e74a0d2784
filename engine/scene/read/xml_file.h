// XmlFile: a scene file as a tree whose nodes know their line, and the list of what is wrong with
// it: of load_scene, and of drawings in XML.
//
// Reading goes on after a mistake, so that a person sees all of them at once.
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <pugixml.hpp>

#include "engine/base/expected.h"

namespace rayloc {

class XmlFile {
 public:
  // `name` stands for the file in errors.
  XmlFile(std::string_view xml, std::string name);

  // The element that all others are in. An Error when the text is no XML or has no such element.
  Expected<pugi::xml_node> parse(const std::string& root_name = "scene");

  const std::string& name() const { return name_; }
  // "scene.xml:12:5: "
  std::string place(const pugi::xml_node& node) const;

  void complain(const pugi::xml_node& node, const std::string& what);
  // False once there are so many that no further one is printed: its text need not be made.
  bool listens() const { return complaints_.size() < kMostComplaints; }
  // All complaints in the order of the file, one a line; kBadInput.
  Expected<void> check() const;

 private:
  // A count, chosen: more than one reads at once.
  static constexpr std::size_t kMostComplaints = 20;

  std::string place(std::ptrdiff_t offset) const;

  std::string_view xml_;
  std::string name_;
  std::vector<std::size_t> line_starts_;
  pugi::xml_document document_;
  std::set<std::pair<std::ptrdiff_t, std::string>> complaints_;  // each once
};

}  // namespace rayloc
