#include "engine/scene/read/xml_file.h"

#include <algorithm>

namespace rayloc {
namespace {

// U+FEFF in UTF-8: some editors begin with it.
constexpr std::string_view kUtf8Mark = "\xEF\xBB\xBF";

// UTF-16 and UTF-32 have zeros between the letters of their first tag.
bool is_wide(std::string_view xml) {
  constexpr std::size_t kFirstTagBytes = 8;  // [bytes], chosen: two letters of UTF-32
  return xml.substr(0, 2) == "\xFF\xFE" || xml.substr(0, 2) == "\xFE\xFF" ||
         xml.substr(0, kFirstTagBytes).find('\0') != std::string_view::npos;
}

}  // namespace

XmlFile::XmlFile(std::string_view xml, std::string name)
    : xml_(xml.substr(xml.substr(0, kUtf8Mark.size()) == kUtf8Mark ? kUtf8Mark.size() : 0)),
      name_(std::move(name)),
      line_starts_{0} {
  for (std::size_t i = 0; i < xml_.size(); ++i) {
    if (xml_[i] == '\n') {
      line_starts_.push_back(i + 1);
    }
  }
}

Expected<pugi::xml_node> XmlFile::parse(const std::string& root_name) {
  if (is_wide(xml_)) {
    return bad_input(name_ + ":1:1: the file is in UTF-16 or UTF-32; save it as UTF-8");
  }
  const pugi::xml_parse_result parsed =
      document_.load_buffer(xml_.data(), xml_.size(), pugi::parse_default, pugi::encoding_utf8);
  if (!parsed) {
    return bad_input(place(parsed.offset) + "this is not well-formed XML: " + parsed.description());
  }
  const pugi::xml_node root = document_.child(root_name.c_str());
  if (!root) {
    return bad_input(name_ + ":1:1: the file has no <" + root_name + "> element");
  }
  for (const pugi::xml_node& other : document_.children()) {
    if (other.type() == pugi::node_element && other != root) {
      complain(other,
               "<" + std::string(other.name()) + "> is not read; a file has one <" + root_name +
                   ">, and all shapes are in it");
    }
  }
  return root;
}

std::string XmlFile::place(std::ptrdiff_t offset) const {
  const auto at =
      std::min(xml_.size(), static_cast<std::size_t>(std::max<std::ptrdiff_t>(offset, 0)));
  const auto after = std::upper_bound(line_starts_.begin(), line_starts_.end(), at);
  const std::size_t start = *(after - 1);
  return name_ + ":" + std::to_string(after - line_starts_.begin()) + ":" +
         std::to_string(at - start + 1) + ": ";
}

std::string XmlFile::place(const pugi::xml_node& node) const {
  // pugixml's offset of an element is that of its name, one after the '<'.
  return place(node.offset_debug() - (node.type() == pugi::node_element ? 1 : 0));
}

void XmlFile::complain(const pugi::xml_node& node, const std::string& what) {
  if (listens()) {
    complaints_.emplace(node.offset_debug(), place(node) + what);
  }
}

Expected<void> XmlFile::check() const {
  if (complaints_.empty()) {
    return {};
  }
  std::string all;
  for (const auto& [offset, complaint] : complaints_) {
    all += (all.empty() ? "" : "\n") + complaint;
  }
  return bad_input(all + (listens() ? "" : "\n" + name_ + ": and perhaps more"));
}

}  // namespace rayloc
