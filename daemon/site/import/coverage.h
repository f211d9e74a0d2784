// Coverage: the part of a plane that the triangles of a scan cover. Only planes.cpp uses this.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace rayloc {

inline constexpr double kCell = 0.05;   // [m], chosen: resolution of the outlines
inline constexpr double kFilled = 0.5;  // share of a cell, chosen

// Covered area of each cell of a plane.
class Coverage {
 public:
  Coverage(double low_u, double high_u, double low_v, double high_v)
      : low_u_(low_u),
        low_v_(low_v),
        columns_(std::max<std::size_t>(
            1, static_cast<std::size_t>(std::ceil((high_u - low_u) / kCell)))),
        rows_(std::max<std::size_t>(1,
                                    static_cast<std::size_t>(std::ceil((high_v - low_v) / kCell)))),
        covered_(columns_ * rows_) {}

  void add(double u, double v, double area) {
    const auto cell = [](double at, std::size_t count) {
      return std::min(count - 1, static_cast<std::size_t>(std::max(0.0, at / kCell)));
    };
    covered_[cell(v - low_v_, rows_) * columns_ + cell(u - low_u_, columns_)] += area;
  }

  struct Rectangle {
    double low_u, low_v, high_u, high_v;
  };
  // The covered cells, each in one rectangle of maximum width, then height.
  std::vector<Rectangle> rectangles() {
    close_gaps();
    std::vector<Rectangle> found;
    for (std::size_t row = 0; row < rows_; ++row) {
      for (std::size_t column = 0; column < columns_; ++column) {
        if (filled_[row * columns_ + column]) {
          found.push_back(take(column, row));
        }
      }
    }
    return found;
  }

 private:
  // Small triangles leave cells empty by chance: a cell with mostly covered neighbours is filled.
  void close_gaps() {
    filled_.resize(covered_.size());
    for (std::size_t row = 0; row < rows_; ++row) {
      for (std::size_t column = 0; column < columns_; ++column) {
        double sum = 0.0;
        double cells = 0.0;
        for (std::size_t r = row == 0 ? 0 : row - 1; r < std::min(rows_, row + 2); ++r) {
          for (std::size_t c = column == 0 ? 0 : column - 1; c < std::min(columns_, column + 2);
               ++c) {
            sum += std::min(1.0, covered_[r * columns_ + c] / (kCell * kCell));
            cells += 1.0;
          }
        }
        filled_[row * columns_ + column] = sum >= kFilled * cells;
      }
    }
  }

  Rectangle take(std::size_t column, std::size_t row) {
    std::size_t end = column;
    while (end < columns_ && filled_[row * columns_ + end]) {
      ++end;
    }
    std::size_t top = row;
    const auto is_full = [&](std::size_t r) {
      for (std::size_t c = column; c < end; ++c) {
        if (!filled_[r * columns_ + c]) {
          return false;
        }
      }
      return true;
    };
    while (top < rows_ && is_full(top)) {
      for (std::size_t c = column; c < end; ++c) {
        filled_[top * columns_ + c] = false;
      }
      ++top;
    }
    const auto at = [](double low, std::size_t cell) {
      return low + kCell * static_cast<double>(cell);
    };
    return {at(low_u_, column), at(low_v_, row), at(low_u_, end), at(low_v_, top)};
  }

  double low_u_, low_v_;
  std::size_t columns_, rows_;
  std::vector<double> covered_;  // [m^2]
  std::vector<bool> filled_;
};

}  // namespace rayloc
