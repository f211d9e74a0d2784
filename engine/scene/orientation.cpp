#include "engine/scene/orientation.h"

#include <array>
#include <cmath>
#include <cstddef>

namespace rayloc {
namespace {

// A number as a sum of doubles that do not overlap, the largest last.
class ExactSum {
 public:
  void add(double value) {
    for (std::size_t i = 0; i < size_; ++i) {
      // Two-sum: sum + error is value + terms_[i] exactly.
      const double sum = value + terms_[i];
      const double other = sum - value;
      terms_[i] = (value - (sum - other)) + (terms_[i] - other);
      value = sum;
    }
    terms_[size_++] = value;
  }
  void add_product(double x, double y) {
    const double product = x * y;
    add(std::fma(x, y, -product));
    add(product);
  }
  int sign() const {
    for (std::size_t i = size_; i > 0; --i) {
      if (terms_[i - 1] != 0.0) {
        return terms_[i - 1] > 0.0 ? 1 : -1;
      }
    }
    return 0;
  }

 private:
  std::array<double, 12> terms_{};  // six products
  std::size_t size_ = 0;
};

}  // namespace

int orientation(const Point2& a, const Point2& b, const Point2& c) {
  const double left = (b.u - a.u) * (c.v - a.v);
  const double right = (b.v - a.v) * (c.u - a.u);
  const double twice_area = left - right;
  // [Shewchuk] fig. 21: maximum error of the six roundings above.
  constexpr double kRounding = 3.3306690738754716e-16;
  if (std::abs(twice_area) > kRounding * (std::abs(left) + std::abs(right))) {
    return twice_area > 0.0 ? 1 : -1;
  }
  ExactSum sum;
  sum.add_product(a.u, b.v);
  sum.add_product(-a.v, b.u);
  sum.add_product(b.u, c.v);
  sum.add_product(-b.v, c.u);
  sum.add_product(c.u, a.v);
  sum.add_product(-c.v, a.u);
  return sum.sign();
}

}  // namespace rayloc
