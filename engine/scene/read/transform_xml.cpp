#include "engine/scene/read/transform_xml.h"

#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string_view>

#include "engine/scene/read/xml_element.h"

namespace rayloc {
namespace {

// Axes are written with four digits and more; in a room of ten metres that is a millimetre.
constexpr double kUnitTolerance = 1e-4;
constexpr double kMatrixRounding = 1e-9;  // of a product of matrices

AffineTransform operator*(const AffineTransform& a, const AffineTransform& b) {
  const Vec3d x = a.linear * Vec3d{b.linear.row0.x, b.linear.row1.x, b.linear.row2.x};
  const Vec3d y = a.linear * Vec3d{b.linear.row0.y, b.linear.row1.y, b.linear.row2.y};
  const Vec3d z = a.linear * Vec3d{b.linear.row0.z, b.linear.row1.z, b.linear.row2.z};
  return {{{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}}, a.apply(b.offset)};
}

// Rodrigues: by `angle` about the unit vector `k`.
Mat3d rotation_about(const Vec3d& k, double angle) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  const double m = 1.0 - c;
  return {{c + k.x * k.x * m, k.x * k.y * m - k.z * s, k.x * k.z * m + k.y * s},
          {k.y * k.x * m + k.z * s, c + k.y * k.y * m, k.y * k.z * m - k.x * s},
          {k.z * k.x * m - k.y * s, k.z * k.y * m + k.x * s, c + k.z * k.z * m}};
}

class StepReader {
 public:
  StepReader(XmlFile& file, const pugi::xml_node& node, OddAxes& odd_axes)
      : file_(file), node_(node), element_(file, node, {}), odd_axes_(odd_axes) {}

  AffineTransform read() {
    const std::string_view kind = node_.name();
    AffineTransform step;
    if (kind == "matrix") {
      step = matrix();
    } else if (kind == "translate") {
      step.offset = vector(0.0);
    } else if (kind == "scale") {
      const Vec3d factor = vector(1.0);
      step.linear = {{factor.x, 0, 0}, {0, factor.y, 0}, {0, 0, factor.z}};
    } else if (kind == "rotate") {
      step.linear = rotation();
    } else {
      element_.complain("<" + std::string(kind) +
                        "> is not supported in a transform; translate, rotate, scale and matrix "
                        "are");
      return step;
    }
    element_.finish();
    return step;
  }

 private:
  AffineTransform matrix() {
    const auto m = parse_numbers(element_.attribute("value"));
    if (!m || m->size() != 16) {
      element_.complain("a <matrix> needs 16 numbers, row by row");
      return {};
    }
    const auto& v = *m;
    if (norm(Vec3d{v[12], v[13], v[14]}) > kMatrixRounding ||
        std::abs(v[15] - 1.0) > kMatrixRounding) {
      element_.complain(
          "the last row of a <matrix> must be 0 0 0 1; a matrix is written row by row, with the "
          "translation at the ends of the rows");
    }
    return {{{v[0], v[1], v[2]}, {v[4], v[5], v[6]}, {v[8], v[9], v[10]}}, {v[3], v[7], v[11]}};
  }

  // Given as value="x y z", value="s", or x="" y="" z="" with `missing` for absent ones.
  Vec3d vector(double missing) {
    constexpr std::array<const char*, 3> kNames{"x", "y", "z"};  // attributes of Mitsuba's vectors
    const std::string value = element_.attribute("value");
    std::array<double, 3> v{missing, missing, missing};
    std::size_t stated = 0;
    for (std::size_t i = 0; i < v.size(); ++i) {
      const std::string text = element_.attribute(kNames.at(i));
      if (!element_.has_attribute(kNames.at(i))) {
        continue;
      }
      ++stated;
      if (const auto number = parse_number(text)) {
        v.at(i) = *number;
      } else {
        element_.complain(std::string("'") + kNames.at(i) + "' must be a number, not '" + text +
                          "'");
      }
    }
    if (!element_.has_attribute("value")) {
      if (stated == 0) {
        element_.complain("a <" + std::string(node_.name()) + "> needs x, y, z or value");
      }
      return {v[0], v[1], v[2]};
    }
    const auto numbers = parse_numbers(value);
    if (stated > 0) {
      element_.complain("either 'value' or x, y, z can be stated");
    } else if (!numbers || (numbers->size() != 1 && numbers->size() != 3)) {
      element_.complain("'value' must be one or three numbers");
    } else {
      return {numbers->front(), (*numbers)[numbers->size() / 2], numbers->back()};
    }
    return {missing, missing, missing};
  }

  Mat3d rotation() {
    const auto degrees = parse_number(element_.attribute("angle"));
    const bool has_axis = element_.has_attribute("value") || element_.has_attribute("x") ||
                          element_.has_attribute("y") || element_.has_attribute("z");
    const Vec3d axis = has_axis ? vector(0.0) : Vec3d{};
    const double length = norm(axis);
    if (!degrees || !(length > 0.0) || !std::isfinite(length)) {
      element_.complain("a <rotate> needs an axis and an 'angle' in degrees");
      return {};
    }
    if (!(std::abs(length - 1.0) <= kUnitTolerance) && odd_axes_.count++ == 0) {
      odd_axes_.first = file_.place(node_);
      odd_axes_.length = length;
    }
    return rotation_about((1.0 / length) * axis, *degrees * std::numbers::pi / 180.0);
  }

  XmlFile& file_;
  pugi::xml_node node_;
  XmlElement element_;
  OddAxes& odd_axes_;
};

}  // namespace

AffineTransform read_transform(XmlFile& file, const pugi::xml_node& transform, OddAxes& odd_axes) {
  AffineTransform world_from_mesh;
  XmlElement element(file, transform, {});
  element.attribute("name");
  element.allow_all_tags();  // StepReader handles them
  for (const pugi::xml_node& step : transform.children()) {
    if (step.type() == pugi::node_element) {
      world_from_mesh = StepReader(file, step, odd_axes).read() * world_from_mesh;
    }
  }
  element.finish();
  return world_from_mesh;
}

}  // namespace rayloc
