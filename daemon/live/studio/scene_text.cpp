#include "daemon/live/studio/scene_text.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include <spdlog/fmt/fmt.h>
#include <pugixml.hpp>

#include "daemon/live/studio/site_text.h"
#include "daemon/live/studio/text_edits.h"
#include "daemon/site/scene/scene_files.h"
#include "engine/em/radio_material.h"

namespace rayloc {
namespace {

constexpr std::string_view kMesh = "mesh-";
constexpr std::string_view kMaterial = "mat-";

std::string without(std::string_view prefix, std::string text) {
  return text.starts_with(prefix) ? text.substr(prefix.size()) : text;
}

// ---- Reading -----------------------------------------------------------------------------------
std::optional<double> number_at(const pugi::xml_node& node, const char* key, double missing) {
  const pugi::xml_attribute attribute = node.attribute(key);
  if (!attribute) {
    return missing;
  }
  char* end = nullptr;
  const double value = std::strtod(attribute.value(), &end);
  return end != attribute.value() && *end == '\0' && std::isfinite(value) ? std::optional(value)
                                                                          : std::nullopt;
}

std::optional<Vec3d> node_vector(const pugi::xml_node& node, double missing) {
  const auto x = number_at(node, "x", missing);
  const auto y = number_at(node, "y", missing);
  const auto z = number_at(node, "z", missing);
  return x && y && z && !node.attribute("value") ? std::optional(Vec3d{*x, *y, *z}) : std::nullopt;
}

// The steps of a transform written by this editor.
struct Steps {
  pugi::xml_node scale;
  pugi::xml_node lift;  // rotation by 90 degrees about x
  pugi::xml_node turn;  // rotation about z
  pugi::xml_node shift;
};

std::optional<double> angle_about(const pugi::xml_node& rotate, const char* axis) {
  const auto v = node_vector(rotate, 0.0);
  const Vec3d wanted{*axis == 'x' ? 1.0 : 0.0, 0.0, *axis == 'z' ? 1.0 : 0.0};
  return v && norm(*v - wanted) == 0.0 ? number_at(rotate, "angle", 0.0) : std::nullopt;
}

pugi::xml_node transform_of(const pugi::xml_node& shape) {
  return shape.find_child_by_attribute("transform", "name", "to_world");
}

std::optional<Steps> steps_of(const pugi::xml_node& shape, bool wall) {
  std::vector<pugi::xml_node> all;
  for (const pugi::xml_node& step : transform_of(shape).children()) {
    if (step.type() == pugi::node_element) {
      all.push_back(step);
    }
  }
  Steps steps;
  auto at = all.begin();
  const auto take = [&](const char* name, pugi::xml_node& into) {
    if (at != all.end() && std::strcmp(at->name(), name) == 0) {
      into = *at++;
    }
  };
  take("scale", steps.scale);
  if (wall) {
    take("rotate", steps.lift);
  }
  take("rotate", steps.turn);
  take("translate", steps.shift);
  const bool whole = at == all.end() && steps.scale && steps.shift &&
                     node_vector(steps.scale, 1.0) && node_vector(steps.shift, 0.0) &&
                     (!wall || (angle_about(steps.lift, "x") == 90.0 && steps.turn)) &&
                     (!steps.turn || angle_about(steps.turn, "z"));
  return whole ? std::optional(steps) : std::nullopt;
}

DraftObject read_shape(const pugi::xml_node& shape) {
  DraftObject one;
  one.was = shape.attribute("id").value();
  one.name = without(kMesh, one.was);
  one.material = without(kMaterial, shape.child("ref").attribute("id").value());
  const std::string_view type = shape.attribute("type").value();
  const bool wall = type == "rectangle";
  const auto steps = type == "cube" || wall ? steps_of(shape, wall) : std::nullopt;
  if (!steps) {
    return one;
  }
  const Vec3d half = *node_vector(steps->scale, 1.0);
  const Vec3d middle = *node_vector(steps->shift, 0.0);
  const double yaw = steps->turn ? *angle_about(steps->turn, "z") : 0.0;
  if (!wall) {
    one.form = DraftForm::kBox;
    one.centre = middle;
    one.size = 2.0 * half;
    one.yaw_deg = yaw;
    return one;
  }
  one.form = DraftForm::kWall;
  const double angle = yaw * std::numbers::pi / 180.0;
  const double dx = half.x * std::cos(angle);
  const double dy = half.x * std::sin(angle);
  one.from = {middle.x - dx, middle.y - dy};
  one.to = {middle.x + dx, middle.y + dy};
  one.height = 2.0 * half.y;
  one.bottom = middle.z - half.y;
  return one;
}

// ---- Writing -----------------------------------------------------------------------------------
std::string xyz(const char* tag, const Vec3d& v, bool flat = false) {
  return fmt::format(R"(<{} x="{}" y="{}"{}/>)",
                     tag,
                     number_text(v.x),
                     number_text(v.y),
                     flat ? "" : fmt::format(R"( z="{}")", number_text(v.z)));
}

struct StepTexts {
  std::string scale;
  std::string turn;
  std::string shift;
};

StepTexts texts_of(const DraftObject& one) {
  const auto turn = [](double degrees) {
    return fmt::format(R"(<rotate z="1" angle="{}"/>)", number_text(degrees));
  };
  if (one.form == DraftForm::kBox) {
    return {xyz("scale", 0.5 * one.size), turn(one.yaw_deg), xyz("translate", one.centre)};
  }
  const double dx = one.to[0] - one.from[0];
  const double dy = one.to[1] - one.from[1];
  return {xyz("scale", {0.5 * std::hypot(dx, dy), 0.5 * one.height, 1.0}, true),
          turn(std::atan2(dy, dx) * 180.0 / std::numbers::pi),
          xyz("translate",
              {0.5 * (one.from[0] + one.to[0]),
               0.5 * (one.from[1] + one.to[1]),
               one.bottom + 0.5 * one.height})};
}

std::string shape_text(const DraftObject& one, const std::string& material_id) {
  const StepTexts steps = texts_of(one);
  const bool wall = one.form == DraftForm::kWall;
  std::string text =
      fmt::format("    <shape type=\"{}\" id=\"mesh-{}\">\n        <transform name=\"to_world\">\n",
                  wall ? "rectangle" : "cube",
                  one.name);
  for (const std::string& step : {steps.scale,
                                  std::string(wall ? R"(<rotate x="1" angle="90"/>)" : ""),
                                  wall || one.yaw_deg != 0.0 ? steps.turn : "",
                                  steps.shift}) {
    text += step.empty() ? "" : "            " + step + "\n";
  }
  return text +
         fmt::format("        </transform>\n        <ref id=\"{}\" name=\"bsdf\"/>\n    </shape>\n",
                     material_id);
}

// An object thinner than a millimetre is a typing error.
bool has_size(const DraftObject& one) {
  constexpr double kLeast = 1e-3;  // [m]
  if (one.form == DraftForm::kBox) {
    return std::min({one.size.x, one.size.y, one.size.z}) >= kLeast;
  }
  return one.form == DraftForm::kWall && one.height >= kLeast &&
         std::hypot(one.to[0] - one.from[0], one.to[1] - one.from[1]) >= kLeast;
}

Error no_size(const DraftObject& one) {
  return {ErrorKind::kBadInput,
          "the object '" + one.name +
              "' needs a name of letters, digits, '-' and '_', and a size of a millimetre or more"};
}

class SceneEditing {
 public:
  SceneEditing(const std::string& xml, const std::string& name) : xml_(xml), name_(name) {}

  Expected<void> open() {
    const pugi::xml_parse_result parsed =
        document_.load_buffer(xml_.data(), xml_.size(), pugi::parse_default, pugi::encoding_utf8);
    if (!parsed || !document_.child("scene")) {
      return bad_input(name_ + ": " + (parsed ? "there is no <scene>" : parsed.description()));
    }
    for (const pugi::xml_node& shape : scene().children("shape")) {
      if (begin_of(shape) == std::string::npos) {
        return bad_input(name_ + ": is not in UTF-8; save it so");
      }
    }
    return {};
  }

  pugi::xml_node scene() const { return document_.child("scene"); }

  Expected<std::string> edit(const std::vector<DraftObject>& wanted) {
    pugi::xml_node last;
    for (const pugi::xml_node& shape : scene().children("shape")) {
      last = shape;
      const DraftObject is = read_shape(shape);
      const auto found =
          is.was.empty() ? wanted.end()
                         : std::find_if(wanted.begin(), wanted.end(), [&](const DraftObject& one) {
                             return one.was == is.was;
                           });
      if (found != wanted.end()) {
        change(shape, is, *found);
      } else if (!is.was.empty()) {
        erase(shape);
      }
    }
    const std::size_t at = last ? line_end(end_of(last)) : xml_.rfind("</scene>");
    for (const DraftObject& one : wanted) {
      RAYLOC_TRY(one.was.empty() ? add(one, at) : Expected<void>());
    }
    return error_ ? Expected<std::string>(tl::make_unexpected(*error_)) : edits_.apply(xml_);
  }

 private:
  // npos: the text is not at the position given by the parser.
  std::size_t begin_of(const pugi::xml_node& node) const {
    const auto at = static_cast<std::size_t>(node.offset_debug());
    const bool there = node.offset_debug() > 0 && at < xml_.size() && xml_[at - 1] == '<' &&
                       xml_.compare(at, std::strlen(node.name()), node.name()) == 0;
    return there ? at - 1 : std::string::npos;
  }

  // Position after the tag or comment that begins there.
  std::size_t end_of_tag(std::size_t at) const {
    if (xml_.compare(at, 4, "<!--") == 0) {
      return xml_.find("-->", at) + 3;
    }
    for (char quote = '\0'; at < xml_.size(); ++at) {
      const char c = xml_[at];
      if (quote != '\0') {
        quote = c == quote ? '\0' : quote;
      } else if (c == '"' || c == '\'') {
        quote = c;
      } else if (c == '>') {
        return at + 1;
      }
    }
    return xml_.size();
  }

  // Position after the end of a parsed element: its tags are balanced.
  std::size_t end_of(const pugi::xml_node& node) const {
    std::size_t at = begin_of(node);
    for (int depth = 0; at != std::string::npos && at < xml_.size(); at = xml_.find('<', at)) {
      const std::size_t end = end_of_tag(at);
      const bool other = xml_[at + 1] == '!' || xml_[at + 1] == '?';
      depth += other || xml_[end - 2] == '/' ? 0 : xml_[at + 1] == '/' ? -1 : 1;
      at = end;
      if (!other && depth == 0) {
        return end;
      }
    }
    return xml_.size();
  }

  std::size_t line_end(std::size_t at) const {
    const std::size_t end = xml_.find('\n', at);
    const std::size_t text = xml_.find_first_not_of(" \t\r", at);
    return end != std::string::npos && text == end ? end + 1 : at;
  }

  std::size_t line_begin(std::size_t at) const {
    const std::size_t before = xml_.rfind('\n', at);
    const std::size_t begin = before == std::string::npos ? 0 : before + 1;
    return xml_.find_first_not_of(" \t", begin) == at ? begin : at;
  }

  std::string indent_at(std::size_t at) const {
    const std::size_t begin = line_begin(at);
    return xml_.substr(begin, at - begin);
  }

  void replace(const pugi::xml_node& node, const std::string& text) {
    if (begin_of(node) == std::string::npos) {
      error_ = Error{ErrorKind::kBadInput,
                     "the scene has no element that can be replaced by " + text +
                         "; give the object a <ref name=\"bsdf\"> by hand, then draw again"};
      return;
    }
    edits_.replace(begin_of(node), end_of(node), text);
  }

  void erase(const pugi::xml_node& shape) {
    edits_.replace(line_begin(begin_of(shape)), line_end(end_of(shape)), "");
  }

  void change(const pugi::xml_node& shape, const DraftObject& is, const DraftObject& wanted) {
    if (is.material != wanted.material) {
      replace(shape.child("ref"), fmt::format(R"(<ref id="{}" name="bsdf"/>)", material(wanted)));
    }
    if (is.name != wanted.name) {
      rename(shape, is, wanted);
    }
    if (is.form == DraftForm::kMesh) {
      move(shape, wanted.moved);
      return;
    }
    const StepTexts before = texts_of(is);
    const StepTexts after = texts_of(wanted);
    // An unchanged transform stays in its original notation.
    if (is.form == wanted.form && before.scale == after.scale && before.turn == after.turn &&
        before.shift == after.shift) {
      return;
    }
    if (is.form != wanted.form || !has_size(wanted)) {
      error_ = no_size(wanted);
      return;
    }
    const Steps steps = *steps_of(shape, is.form == DraftForm::kWall);
    if (before.scale != after.scale) {
      replace(steps.scale, after.scale);
    }
    std::string shift = after.shift;
    if (before.turn != after.turn && steps.turn) {
      replace(steps.turn, after.turn);
    } else if (before.turn != after.turn) {
      shift = after.turn + "\n" + indent_at(begin_of(steps.shift)) + shift;
    }
    if (before.shift != shift) {
      replace(steps.shift, shift);
    }
  }

  void rename(const pugi::xml_node& shape, const DraftObject& is, const DraftObject& wanted) {
    const std::size_t begin = begin_of(shape);
    const std::size_t end = end_of_tag(begin);
    for (const char quote : {'"', '\''}) {
      const std::string old = std::string("id=") + quote + is.was + quote;
      const std::size_t at = xml_.find(old, begin);
      if (at < end && is_object_name(wanted.name)) {
        edits_.replace(at, at + old.size(), fmt::format("id=\"mesh-{}\"", wanted.name));
        return;
      }
    }
    error_ = Error{ErrorKind::kBadInput,
                   name_ + ": '" + is.name + "' cannot be called '" + wanted.name +
                       "' here; write letters, digits, '-' and '_'"};
  }

  void move(const pugi::xml_node& shape, const std::array<double, 2>& by) {
    if (by[0] == 0.0 && by[1] == 0.0) {
      return;
    }
    const pugi::xml_node transform = transform_of(shape);
    const pugi::xml_node last = transform.last_child();
    const auto shift = std::strcmp(last.name(), "translate") == 0 ? node_vector(last, 0.0)
                                                                  : std::optional<Vec3d>();
    const Vec3d sum = shift.value_or(Vec3d{}) + Vec3d{by[0], by[1], 0.0};
    const std::string text = xyz("translate", sum);
    if (shift) {
      return replace(last, text);
    }
    const pugi::xml_node before = transform ? transform : shape;
    const std::size_t end = xml_.rfind('<', end_of(before) - 1);
    const std::string outer = indent_at(begin_of(before));
    std::string line = transform ? outer + "    " + text + "\n"
                                 : outer + "    <transform name=\"to_world\">\n" + outer +
                                       "        " + text + "\n" + outer + "    </transform>\n";
    const std::size_t at = line_begin(end);
    if (transform && xml_[end_of(transform) - 2] == '/') {  // <transform name="to_world"/>
      replace(transform, "<transform name=\"to_world\">" + text + "</transform>");
    } else {
      edits_.replace(at, at, at == end ? text : line);
    }
  }

  Expected<void> add(const DraftObject& one, std::size_t at) {
    if (!is_object_name(one.name) || !has_size(one)) {
      return tl::make_unexpected(no_size(one));
    }
    const std::string id = material(one);
    edits_.replace(at, at, shape_text(one, id));
    return {};
  }

  // The id of the <bsdf>, which is added if it does not exist.
  std::string material(const DraftObject& one) {
    const std::string& name = one.material;
    const auto names = itu_material_names();
    const std::string bare = without("itu_", name);
    for (const std::string& id : {name, "mat-" + name, "mat-itu_" + bare, "itu_" + bare, bare}) {
      if (scene().find_child_by_attribute("bsdf", "id", id.c_str()) || written_.contains(id)) {
        return id;
      }
    }
    if (std::find(names.begin(), names.end(), bare) == names.end()) {
      error_ = Error{
          ErrorKind::kBadInput,
          "there is no material '" + name + "'; take one of the scene's or of ITU-R P.2040-4"};
      return name;
    }
    std::string id = "mat-itu_" + bare;
    written_.insert(id);
    pugi::xml_node last;
    for (const pugi::xml_node& bsdf : scene().children("bsdf")) {
      last = bsdf;
    }
    const std::size_t at = last ? line_end(end_of(last)) : line_end(end_of_tag(begin_of(scene())));
    edits_.replace(at,
                   at,
                   fmt::format("    <bsdf type=\"itu-radio-material\" id=\"{}\">\n"
                               "        <string name=\"type\" value=\"{}\"/>\n"
                               "        <float name=\"thickness\" value=\"{}\"/>\n    </bsdf>\n",
                               id,
                               bare,
                               number_text(one.thickness)));
    return id;
  }

  const std::string& xml_;
  const std::string& name_;
  pugi::xml_document document_;
  TextEdits edits_;
  std::set<std::string> written_;  // ids of new <bsdf>s
  std::optional<Error> error_;
};

}  // namespace

Expected<std::vector<DraftObject>> read_scene_text(const std::string& xml,
                                                   const std::string& name) {
  SceneEditing scene(xml, name);
  RAYLOC_TRY(scene.open());
  std::vector<DraftObject> objects;
  for (const pugi::xml_node& shape : scene.scene().children("shape")) {
    if (shape.attribute("id")) {
      objects.push_back(read_shape(shape));
    }
  }
  return objects;
}

std::vector<std::string> scene_materials(const std::string& xml) {
  pugi::xml_document document;
  document.load_buffer(xml.data(), xml.size());
  std::vector<std::string> names;
  for (const pugi::xml_node& bsdf : document.child("scene").children("bsdf")) {
    names.push_back(without(kMaterial, bsdf.attribute("id").value()));
  }
  return names;
}

Expected<std::string> edit_scene_text(const std::string& xml,
                                      const std::string& name,
                                      const std::vector<DraftObject>& wanted) {
  SceneEditing scene(xml, name);
  RAYLOC_TRY(scene.open());
  return scene.edit(wanted);
}

}  // namespace rayloc
