#include "engine/em/antenna_gain_table.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

#include "engine/base/constants.h"
#include "engine/base/csv_reader.h"

namespace rayloc {
namespace {

constexpr std::size_t kFewestPhi = 4;    // a count of columns, chosen: one every 90 degrees
constexpr std::size_t kFewestTheta = 3;  // a count of lines, chosen: the poles and the horizon
constexpr double kLowestGain = -200.0;   // [dBi]
constexpr double kHighestGain = 60.0;    // [dBi]
constexpr std::size_t kMaxCells = 3601;  // per line, and maximum of lines: a tenth of a degree
constexpr double kStepTolerance = 1e-3;  // of a rounded angle, in steps

struct Line {
  int number = 0;  // from 1
  CsvReader::Record cells;
};

// In the form that a person would write.
std::string to_text(double value) {
  std::array<char, 32> text{};
  const auto [end, status] =
      std::to_chars(text.begin(), text.end(), value, std::chars_format::general, 6);
  return {text.begin(), end};
}

// Weights of four neighbouring samples at t in [0, 1] between the middle two: the spline through
// them whose slope at a sample is half the difference of its neighbours.
using Weights = std::array<double, 4>;
Weights spline(double t) {
  return {0.5 * t * (-1.0 + t * (2.0 - t)),
          1.0 + 0.5 * t * t * (-5.0 + 3.0 * t),
          0.5 * t * (1.0 + t * (4.0 - 3.0 * t)),
          0.5 * t * t * (-1.0 + t)};
}
Weights spline_slope(double t) {
  return {-0.5 + t * (2.0 - 1.5 * t),
          t * (-5.0 + 4.5 * t),
          0.5 + t * (4.0 - 4.5 * t),
          t * (-1.0 + 1.5 * t)};
}

double dot(const Weights& weights, const Weights& values) {
  return weights[0] * values[0] + weights[1] * values[1] + weights[2] * values[2] +
         weights[3] * values[3];
}

// Reads the numbers of a table; errors name the line.
class TableReader {
 public:
  explicit TableReader(const std::string& name) : name_(name) {}

  Expected<void> read(std::string_view text) {
    CsvReader reader(text, name_, ErrorKind::kConfiguration, kMaxCells);
    for (CsvReader::Record record;;) {
      const auto more = reader.next(record);
      RAYLOC_TRY(more);
      separator_ = reader.separator();
      if (!*more) {
        return {};
      }
      if (lines_.size() == kMaxCells) {
        return error_at(record.cells[0].line,
                        "more than " + std::to_string(kMaxCells) + " lines of theta");
      }
      lines_.push_back({record.cells[0].line, std::move(record)});
    }
  }

  // The angles of the columns [degrees].
  Expected<std::vector<double>> phi() const {
    if (lines_.empty()) {
      return error_at(1, "the table is empty; write theta\\phi,0,90,180,270 and a line per theta");
    }
    auto numbers = numbers_of(lines_.front());
    if (!numbers) {
      return numbers;
    }
    const std::size_t count = numbers->size();
    const int line = lines_.front().number;
    if (count >= 2 && numbers->back() - numbers->front() == 360.0) {
      return error_at(line, "the last column repeats the first, a turn later; leave it out");
    }
    if (count < kFewestPhi || count % 2 != 0) {
      return error_at(line,
                      std::to_string(count) + " columns of phi; an even number is needed, " +
                          std::to_string(kFewestPhi) + " or more");
    }
    const double step = 360.0 / static_cast<double>(count);
    for (std::size_t k = 0; k < count; ++k) {
      const double expected = numbers->front() + step * static_cast<double>(k);
      if (!(std::abs((*numbers)[k] - expected) <= kStepTolerance * step)) {
        return error_at(line, uneven("phi", (*numbers)[k], count, "once around", step, expected));
      }
    }
    return numbers;
  }

  // The gains, [theta][phi].
  Expected<std::vector<double>> gains(std::size_t phi_count) const {
    const std::size_t count = lines_.size() - 1;
    if (count < kFewestTheta) {
      return error_at(lines_.back().number,
                      std::to_string(count) + " lines of theta; at least " +
                          std::to_string(kFewestTheta) + " are needed, from 0 to 180 degrees");
    }
    const double step = 180.0 / static_cast<double>(count - 1);
    std::vector<double> gains;
    gains.reserve(count * phi_count);
    for (std::size_t i = 0; i < count; ++i) {
      const Line& line = lines_[i + 1];
      const auto row = row_of(line, phi_count);
      RAYLOC_TRY(row);
      const double expected = step * static_cast<double>(i);
      if (!(std::abs(row->front() - expected) <= kStepTolerance * step)) {
        return error_at(line.number,
                        uneven("theta", row->front(), count, "from 0 to 180", step, expected));
      }
      gains.insert(gains.end(), std::next(row->begin()), row->end());
    }
    return gains;
  }

 private:
  tl::unexpected<Error> error_at(int line, const std::string& what) const {
    return make_error(ErrorKind::kConfiguration, name_ + ":" + std::to_string(line) + ": " + what);
  }

  static std::string uneven(const std::string& angle,
                            double value,
                            std::size_t count,
                            const std::string& range,
                            double step,
                            double expected) {
    return angle + " is " + to_text(value) + " degrees; " + std::to_string(count) + " values " +
           range + " are " + to_text(step) + " degrees apart, so this one is " + to_text(expected);
  }

  // All cells but the first.
  Expected<std::vector<double>> numbers_of(const Line& line) const {
    std::vector<double> numbers;
    for (std::size_t c = 1; c < line.cells.size(); ++c) {
      const auto number = parse_csv_number(line.cells[c], separator_);
      if (!number) {
        return error_at(line.number, not_a_number(line, c));
      }
      numbers.push_back(*number);
    }
    return numbers;
  }

  // The angle of the line, then its gains.
  Expected<std::vector<double>> row_of(const Line& line, std::size_t phi_count) const {
    if (line.cells.size() != phi_count + 1) {
      return error_at(line.number,
                      std::to_string(line.cells.size()) + " cells; an angle and " +
                          std::to_string(phi_count) + " gains are needed, as in the first line");
    }
    const auto theta = parse_csv_number(line.cells[0], separator_);
    if (!theta) {
      return error_at(line.number, not_a_number(line, 0));
    }
    auto row = numbers_of(line);
    if (!row) {
      return row;
    }
    for (const double gain : *row) {
      if (gain < kLowestGain || gain > kHighestGain) {
        return error_at(line.number,
                        "a gain of " + to_text(gain) + " dBi; write decibels from " +
                            to_text(kLowestGain) + " to " + to_text(kHighestGain));
      }
    }
    row->insert(row->begin(), *theta);
    return row;
  }

  static std::string not_a_number(const Line& line, std::size_t cell) {
    return "cell " + std::to_string(cell + 1) + " is " + quoted_cell(line.cells[cell]) +
           "; write a number";
  }

  std::vector<Line> lines_;
  char separator_ = ',';
  const std::string& name_;
};

}  // namespace

Expected<AntennaGainTable> AntennaGainTable::parse(std::string_view text, std::string name) {
  TableReader reader(name);
  RAYLOC_TRY(reader.read(text));
  const auto phi = reader.phi();
  RAYLOC_TRY(phi);
  auto gains = reader.gains(phi->size());
  RAYLOC_TRY(gains);
  AntennaGainTable table;
  table.phi_count_ = phi->size();
  table.first_phi_ = phi->front() * kDegree;
  table.dbi_ = *std::move(gains);
  table.name_ = std::move(name);
  return table;
}

double AntennaGainTable::sample(std::ptrdiff_t i, std::ptrdiff_t k) const {
  const auto rows = static_cast<std::ptrdiff_t>(theta_count());
  const auto columns = static_cast<std::ptrdiff_t>(phi_count_);
  if (i < 0 || i >= rows) {  // continues on the far side of a pole
    i = i < 0 ? -i : 2 * (rows - 1) - i;
    k += columns / 2;
  }
  k = ((k % columns) + columns) % columns;
  return dbi_[static_cast<std::size_t>(i * columns + k)];
}

AntennaGainTable::Gain AntennaGainTable::at(double theta, double phi) const {
  const double rows_per_radian = static_cast<double>(theta_count() - 1) / std::numbers::pi;
  const double columns_per_radian = static_cast<double>(phi_count_) / (2.0 * std::numbers::pi);
  const double u = theta * rows_per_radian;
  const double v = std::remainder(phi - first_phi_, 2.0 * std::numbers::pi) * columns_per_radian;
  const double i = std::clamp(std::floor(u), 0.0, static_cast<double>(theta_count() - 2));
  const double k = std::floor(v);
  const Weights over_phi = spline(v - k);
  const Weights over_phi_slope = spline_slope(v - k);
  Weights along_theta{};  // the gain at phi in each row
  Weights slope{};        // derivative by the column
  for (std::ptrdiff_t row = 0; row < 4; ++row) {
    Weights values{};
    for (std::ptrdiff_t column = 0; column < 4; ++column) {
      values[static_cast<std::size_t>(column)] = sample(
          static_cast<std::ptrdiff_t>(i) + row - 1, static_cast<std::ptrdiff_t>(k) + column - 1);
    }
    along_theta[static_cast<std::size_t>(row)] = dot(over_phi, values);
    slope[static_cast<std::size_t>(row)] = dot(over_phi_slope, values);
  }
  const Weights over_theta = spline(u - i);
  return {dot(over_theta, along_theta),
          dot(spline_slope(u - i), along_theta) * rows_per_radian,
          dot(over_theta, slope) * columns_per_radian};
}

}  // namespace rayloc
