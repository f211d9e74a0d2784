// XmlFile: a scene file as a tree whose nodes have a line number, and the list of its faults: for
// load_scene, and for drawings in XML.
//
// Reading continues after a mistake, so that all of them are reported at once.
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
  // `name` denotes the file in errors.
  XmlFile(std::string_view xml, std::string name);

  // The root element. An Error when the text is no XML or has no such element.
  Expected<pugi::xml_node> parse(const std::string& root_name = "scene");

  const std::string& name() const { return name_; }
  // "scene.xml:12:5: "
  std::string place(const pugi::xml_node& node) const;

  void complain(const pugi::xml_node& node, const std::string& what);
  // False once the limit of printed complaints is reached: further texts need not be made.
  bool listens() const { return complaints_.size() < kMaxComplaints; }
  // All complaints in the order of the file, one per line; kBadInput.
  Expected<void> check() const;

 private:
  // A count, chosen: more than a person reads at once.
  static constexpr std::size_t kMaxComplaints = 20;

  std::string place(std::ptrdiff_t offset) const;

  std::string_view xml_;
  std::string name_;
  std::vector<std::size_t> line_starts_;
  pugi::xml_document document_;
  std::set<std::pair<std::ptrdiff_t, std::string>> complaints_;  // each once
};

}  // namespace rayloc
