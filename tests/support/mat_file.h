// Reads the only kind of MATLAB file among the public recordings: a level 5 file with one
// compressed matrix of complex int16 (The MathWorks, MAT-File Format, chapter 1).
#pragma once

#include <complex>
#include <cstddef>
#include <string>
#include <vector>

namespace rayloc::test {

struct ComplexMatrix {
  std::size_t rows = 0;
  std::size_t columns = 0;
  std::vector<std::complex<int>> values;  // row by row
};

// Throws std::runtime_error for any other file.
ComplexMatrix read_mat_file(const std::string& path);

}  // namespace rayloc::test
