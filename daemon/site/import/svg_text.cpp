#include "daemon/site/import/svg_text.h"

#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <utility>

#include "daemon/site/import/drawing.h"
#include "daemon/site/import/svg_arc.h"
#include "engine/base/constants.h"

namespace rayloc {
namespace {

constexpr double kInch = 0.0254;  // [m]
constexpr std::string_view kSpace = " \t\r\n\f";
constexpr std::string_view kCommands = "MmLlHhVvCcSsQqTtAaZz";

class Scanner {
 public:
  explicit Scanner(std::string_view text) : text_(text) {}

  void skip_space() {
    const std::size_t next = text_.find_first_not_of(kSpace);
    text_.remove_prefix(next == std::string_view::npos ? text_.size() : next);
  }
  // Spaces with at most one comma.
  void skip_separator() {
    skip_space();
    if (text_.starts_with(',')) {
      text_.remove_prefix(1);
      skip_space();
    }
  }
  bool has_ended() const { return text_.empty(); }
  char front() const { return text_.empty() ? '\0' : text_.front(); }
  char take() {
    const char c = front();
    text_.remove_prefix(text_.empty() ? 0 : 1);
    return c;
  }
  bool take(char wanted) {
    const bool found = front() == wanted && !text_.empty();
    text_.remove_prefix(found ? 1 : 0);
    return found;
  }
  std::string_view take_word() {
    std::size_t length = 0;
    while (length < text_.size() && ((text_[length] >= 'a' && text_[length] <= 'z') ||
                                     (text_[length] >= 'A' && text_[length] <= 'Z'))) {
      ++length;
    }
    const std::string_view word = text_.substr(0, length);
    text_.remove_prefix(length);
    return word;
  }
  std::optional<double> number() {
    std::string_view text = text_;
    text.remove_prefix(text.starts_with('+') ? 1 : 0);
    double value = 0.0;
    const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (failed != std::errc() || !std::isfinite(value)) {
      return std::nullopt;
    }
    text_ = text_.substr(static_cast<std::size_t>(end - text_.data()));
    return value;
  }
  // Flag of an arc: one digit, which needs no separator behind it.
  std::optional<bool> flag() {
    skip_separator();
    const bool is_set = take('1');
    return is_set || take('0') ? std::optional(is_set) : std::nullopt;
  }

 private:
  std::string_view text_;
};

FloorPoint between(const std::array<FloorPoint, 4>& p, double t) {
  const double s = 1.0 - t;
  FloorPoint at{};
  for (const std::size_t axis : {0U, 1U}) {
    at[axis] = s * s * s * p[0][axis] + 3 * s * s * t * p[1][axis] + 3 * s * t * t * p[2][axis] +
               t * t * t * p[3][axis];
  }
  return at;
}

class PathReader {
 public:
  explicit PathReader(std::string_view text) : text_(text) {}

  std::optional<std::vector<DrawnLine>> read() {
    for (text_.skip_space(); !text_.has_ended(); text_.skip_separator()) {
      if (kCommands.find(text_.front()) != std::string_view::npos) {
        command_ = text_.take();
        text_.skip_space();
      } else if (command_ == '\0' || command_ == 'Z' || command_ == 'z') {
        return std::nullopt;
      }
      if (!step()) {
        return std::nullopt;
      }
    }
    end_line();
    return std::move(lines_);
  }

 private:
  bool step() {
    const bool relative = command_ >= 'a';
    const FloorPoint from = relative ? at_ : FloorPoint{};
    const char kind = static_cast<char>(relative ? command_ - 'a' + 'A' : command_);
    const FloorPoint control = std::exchange(control_, at_);
    const char before = std::exchange(before_, kind);
    switch (kind) {
      case 'M':
        end_line();
        command_ = relative ? 'l' : 'L';  // implicit command after a move
        return move_to(from);
      case 'L':
        return line_to(from);
      case 'H':
      case 'V':
        return along_axis(kind == 'H' ? 0 : 1, from);
      case 'C':
      case 'S':
        return cubic(kind == 'S', before == 'C' || before == 'S' ? control : at_, from);
      case 'Q':
      case 'T':
        return quadratic(kind == 'T', before == 'Q' || before == 'T' ? control : at_, from);
      case 'A':
        return arc(from);
      default:
        return close();
    }
  }

  std::optional<FloorPoint> point(const FloorPoint& from) {
    text_.skip_separator();
    const auto x = text_.number();
    text_.skip_separator();
    const auto y = x ? text_.number() : std::nullopt;
    return y ? std::optional<FloorPoint>({from[0] + *x, from[1] + *y}) : std::nullopt;
  }
  bool move_to(const FloorPoint& from) {
    const auto to = point(from);
    at_ = start_ = control_ = to.value_or(at_);
    return to.has_value();
  }
  void go(const FloorPoint& to) {
    if (count_ <= kMaxDrawnPoints) {  // one more exceeds the limit, which the reader reports
      if (line_.points.empty()) {
        line_.points.push_back(at_);
      }
      line_.points.push_back(to);
      ++count_;
    }
    at_ = control_ = to;
  }
  bool line_to(const FloorPoint& from) {
    const auto to = point(from);
    if (to) {
      go(*to);
    }
    return to.has_value();
  }
  bool along_axis(std::size_t axis, const FloorPoint& from) {
    text_.skip_separator();
    const auto number = text_.number();
    if (number) {
      FloorPoint to = at_;
      to[axis] = from[axis] + *number;
      go(to);
    }
    return number.has_value();
  }
  void curve(const std::array<FloorPoint, 4>& p) {
    for (int i = 1; i <= kPieces; ++i) {
      go(between(p, static_cast<double>(i) / kPieces));
    }
  }
  static FloorPoint mirrored(const FloorPoint& p, const FloorPoint& about) {
    return {2 * about[0] - p[0], 2 * about[1] - p[1]};
  }
  bool cubic(bool is_smooth, const FloorPoint& control, const FloorPoint& from) {
    const auto first = is_smooth ? std::optional(mirrored(control, at_)) : point(from);
    const auto second = first ? point(from) : std::nullopt;
    const auto to = second ? point(from) : std::nullopt;
    if (to) {
      curve({at_, *first, *second, *to});
      control_ = *second;
    }
    return to.has_value();
  }
  bool quadratic(bool is_smooth, const FloorPoint& control, const FloorPoint& from) {
    const auto middle = is_smooth ? std::optional(mirrored(control, at_)) : point(from);
    const auto to = middle ? point(from) : std::nullopt;
    if (to) {
      const auto towards = [&](const FloorPoint& end) {
        return FloorPoint{end[0] + 2.0 / 3.0 * ((*middle)[0] - end[0]),
                          end[1] + 2.0 / 3.0 * ((*middle)[1] - end[1])};
      };
      curve({at_, towards(at_), towards(*to), *to});
      control_ = *middle;
    }
    return to.has_value();
  }
  bool arc(const FloorPoint& from) {
    const auto radii = point({});
    text_.skip_separator();
    const auto rotated = radii ? text_.number() : std::nullopt;
    const auto is_large = rotated ? text_.flag() : std::nullopt;
    const auto is_clockwise = is_large ? text_.flag() : std::nullopt;
    const auto to = is_clockwise ? point(from) : std::nullopt;
    if (to) {
      for (const FloorPoint& corner :
           chords_of({at_, *to, *radii, *rotated * kDegree, *is_large, *is_clockwise})) {
        go(corner);
      }
    }
    return to.has_value();
  }
  bool close() {
    line_.is_closed = line_.points.size() > 1;
    end_line();
    at_ = control_ = start_;
    return true;
  }
  void end_line() {
    if (line_.is_closed && line_.points.back() == line_.points.front()) {
      line_.points.pop_back();  // was drawn back to the beginning before closing
    }
    if (line_.points.size() > 1) {
      lines_.push_back(std::move(line_));
    }
    line_ = {};
  }

  Scanner text_;
  std::size_t count_ = 0;  // number of points
  std::vector<DrawnLine> lines_;
  DrawnLine line_;
  FloorPoint at_{};
  FloorPoint start_{};
  FloorPoint control_{};  // last control point of a curve
  char command_ = '\0';
  char before_ = '\0';  // kind of the previous command
};

// One element of a list of transforms; empty if it is none, or has a wrong count of numbers.
std::optional<Placing> placing_of(std::string_view name, const std::vector<double>& v) {
  const std::size_t n = v.size();
  if (name == "matrix" && n == 6) {
    return Placing{v[0], v[2], v[1], v[3], v[4], v[5]};
  }
  if (name == "translate" && (n == 1 || n == 2)) {
    return Placing{1.0, 0.0, 0.0, 1.0, v[0], n == 2 ? v[1] : 0.0};
  }
  if (name == "scale" && (n == 1 || n == 2)) {
    return Placing{v[0], 0.0, 0.0, v[n - 1]};
  }
  if (name == "rotate" && n == 1) {
    return rotated_by(v[0] * kDegree);
  }
  if (name == "rotate" && n == 3) {
    return Placing{1.0, 0.0, 0.0, 1.0, v[1], v[2]}
        .after(rotated_by(v[0] * kDegree))
        .after({1.0, 0.0, 0.0, 1.0, -v[1], -v[2]});
  }
  if (name == "skewX" && n == 1) {
    return Placing{1.0, std::tan(v[0] * kDegree), 0.0, 1.0};
  }
  if (name == "skewY" && n == 1) {
    return Placing{1.0, 0.0, std::tan(v[0] * kDegree), 1.0};
  }
  return std::nullopt;
}

}  // namespace

double SvgLength::metres() const {
  constexpr std::array<std::pair<std::string_view, double>, 6> kUnits = {{{"mm", 0.001},
                                                                          {"cm", 0.01},
                                                                          {"in", kInch},
                                                                          {"pt", kInch / 72.0},
                                                                          {"pc", kInch / 6.0},
                                                                          {"Q", 0.00025}}};
  for (const auto& [name, each] : kUnits) {
    if (name == unit) {
      return number * each;
    }
  }
  return 0.0;
}

std::optional<SvgLength> svg_length(std::string_view text) {
  const std::size_t end = text.find_last_not_of(kSpace);
  text = text.substr(0, end == std::string_view::npos ? 0 : end + 1);
  Scanner scanner(text);
  scanner.skip_space();
  const auto number = scanner.number();
  if (!number) {
    return std::nullopt;
  }
  const bool is_share = scanner.take('%');
  const std::string_view unit = is_share ? std::string_view("%") : scanner.take_word();
  return scanner.has_ended() ? std::optional<SvgLength>({*number, unit}) : std::nullopt;
}

std::optional<std::vector<double>> svg_numbers(std::string_view text) {
  std::vector<double> numbers;
  Scanner scanner(text);
  for (scanner.skip_space(); !scanner.has_ended(); scanner.skip_separator()) {
    const auto number = scanner.number();
    if (!number) {
      return std::nullopt;
    }
    numbers.push_back(*number);
  }
  return numbers;
}

std::optional<Placing> svg_transform(std::string_view text) {
  Placing whole;
  Scanner scanner(text);
  for (scanner.skip_space(); !scanner.has_ended(); scanner.skip_separator()) {
    const std::string_view name = scanner.take_word();
    scanner.skip_space();
    if (!scanner.take('(')) {
      return std::nullopt;
    }
    std::vector<double> values;
    for (scanner.skip_space(); !scanner.take(')'); scanner.skip_separator()) {
      const auto number = scanner.number();
      if (!number) {
        return std::nullopt;
      }
      values.push_back(*number);
    }
    const auto one = placing_of(name, values);
    if (!one) {
      return std::nullopt;
    }
    whole = whole.after(*one);
  }
  return whole;
}

std::optional<std::vector<DrawnLine>> svg_path(std::string_view text) {
  return PathReader(text).read();
}

}  // namespace rayloc
