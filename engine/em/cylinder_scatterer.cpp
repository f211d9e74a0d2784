#include "engine/em/cylinder_scatterer.h"

#include <string>
#include <utility>

#include "engine/base/check.h"
#include "engine/base/six_digit_text.h"

namespace rayloc {
namespace {

// Larger over smaller semi-axis.
constexpr double kFlattest = 3.0;
// Above this value the model does not apply to a body, and its tables would be large.
constexpr double kLargestPermittivity = 200.0;

Expected<void> validate(const CylinderBody& body, double k) {
  const auto refuse = [](const std::string& what, double value, const std::string& wanted) {
    return bad_input("body: " + what + " is " + six_digit_text(value) + ", must be " + wanted);
  };
  const double largest = kLargestSection / k;
  for (const double axis : body.semi_axes) {
    if (!(axis > 0.0 && axis <= largest)) {
      return refuse(
          "a semi-axis", axis, "more than 0 and at most " + six_digit_text(largest) + " m");
    }
  }
  const double flat = std::max(body.semi_axes[0], body.semi_axes[1]) /
                      std::min(body.semi_axes[0], body.semi_axes[1]);
  if (flat > kFlattest) {
    return refuse("the ratio of the semi-axes", flat, "at most " + six_digit_text(kFlattest));
  }
  if (!(std::isfinite(body.height) && body.height > 0.0)) {
    return refuse("height", body.height, "more than 0 [m]");
  }
  if (!std::isfinite(body.base)) {
    return refuse("base", body.base, "finite [m]");
  }
  if (!std::isfinite(body.yaw)) {
    return refuse("yaw", body.yaw, "finite [rad]");
  }
  const Complex<double>& permittivity = body.relative_permittivity;
  if (!(permittivity.re >= 1.0 && permittivity.re <= kLargestPermittivity)) {
    return refuse("the relative permittivity",
                  permittivity.re,
                  "between 1 and " + six_digit_text(kLargestPermittivity));
  }
  if (!(std::isfinite(permittivity.im) && permittivity.im <= 0.0)) {
    return refuse("the imaginary part of the relative permittivity",
                  permittivity.im,
                  "0 or less: conductivity is 0 or more");
  }
  return {};
}

}  // namespace

CylinderScatterer::CylinderScatterer(const CylinderBody& body,
                                     double wavelength,
                                     std::shared_ptr<const CylinderSection> section)
    : body_(body),
      wavelength_(wavelength),
      cos_yaw_(std::cos(body.yaw)),
      sin_yaw_(std::sin(body.yaw)),
      section_(std::move(section)) {}

Expected<CylinderScatterer> CylinderScatterer::create(const CylinderBody& body, double wavelength) {
  RAYLOC_CHECK(std::isfinite(wavelength) && wavelength > 0.0);
  const double k = 2.0 * std::numbers::pi / wavelength;
  RAYLOC_TRY(validate(body, k));
  if (body.semi_axes[0] == body.semi_axes[1]) {
    return CylinderScatterer(
        body, wavelength, make_circular_section(k * body.semi_axes[0], body.relative_permittivity));
  }
  auto section = make_elliptic_section({k * body.semi_axes[0], k * body.semi_axes[1]},
                                       body.relative_permittivity);
  RAYLOC_TRY(section);
  return CylinderScatterer(body, wavelength, std::move(*section));
}

bool CylinderScatterer::contains(const Vec3d& point) const {
  const double x = (cos_yaw_ * point.x + sin_yaw_ * point.y) / body_.semi_axes[0];
  const double y = (cos_yaw_ * point.y - sin_yaw_ * point.x) / body_.semi_axes[1];
  return x * x + y * y <= 1.0 && point.z >= body_.base && point.z <= body_.base + body_.height;
}

}  // namespace rayloc
