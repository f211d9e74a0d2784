#include "engine/base/normal_draws.h"

#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace rayloc {
namespace {

constexpr std::size_t kNormals = 65536;                   // a count, of 16 bits of an index
constexpr std::uint64_t kTableSeed = 12345;               // chosen: any seed
constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15ULL;  // increment of splitmix64
constexpr double kUnit52 = 0x1p-52;                       // of a number of 52 bits

// In (0, 1).
double unit_of(std::uint64_t bits) { return (static_cast<double>(bits >> 12U) + 0.5) * kUnit52; }

// By Box and Muller, shifted and scaled to mean 0 and variance 1: every user draws a large part of
// the table, and an error of its moments would add up over time.
std::vector<float> make_normals() {
  std::vector<double> drawn;
  drawn.reserve(kNormals);
  std::uint64_t state = kTableSeed;
  double sum = 0.0;
  double squares = 0.0;
  while (drawn.size() < kNormals) {
    const double radius = std::sqrt(-2.0 * std::log(unit_of(mixed(state))));
    const double angle = 2.0 * std::numbers::pi * unit_of(mixed(state + kGolden));
    state += 2 * kGolden;
    for (const double value : {radius * std::cos(angle), radius * std::sin(angle)}) {
      drawn.push_back(value);
      sum += value;
      squares += value * value;
    }
  }
  const auto count = static_cast<double>(kNormals);
  const double mean = sum / count;
  const double scale = 1.0 / std::sqrt(squares / count - mean * mean);
  std::vector<float> table;
  table.reserve(kNormals);
  for (const double value : drawn) {
    table.push_back(static_cast<float>(scale * (value - mean)));
  }
  return table;
}

const float* normal_table() {
  static const std::vector<float> kTable = make_normals();
  return kTable.data();
}

}  // namespace

std::uint64_t mixed(std::uint64_t value) {
  value += kGolden;
  value = (value ^ (value >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  value = (value ^ (value >> 27U)) * 0x94d049bb133111ebULL;
  return value ^ (value >> 31U);
}

NormalDraws::NormalDraws(std::uint64_t key)
    : table_(normal_table()),
      index_(static_cast<std::uint32_t>(mixed(key) >> 32U)),
      state_(mixed(key ^ kGolden)) {}

std::uint64_t NormalDraws::next() {
  const std::uint64_t bits = mixed(state_);
  state_ += kGolden;
  return bits;
}

std::uint32_t NormalDraws::bits16() {
  if (parts_ == 0) {
    bits_ = next();
    parts_ = 4;
  }
  --parts_;
  const auto part = static_cast<std::uint32_t>(bits_ & 0xffffU);
  bits_ >>= 16U;
  return part;
}

double NormalDraws::uniform() { return unit_of(next()); }

}  // namespace rayloc
