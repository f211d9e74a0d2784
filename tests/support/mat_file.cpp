#include "tests/support/mat_file.h"

#include <zlib.h>

#include <cstdint>
#include <cstring>
#include <stdexcept>

#include "tests/support/recording.h"

namespace rayloc::test {
namespace {

using Bytes = std::vector<std::byte>;

constexpr std::size_t kMatHeader = 128;
constexpr std::size_t kTag = 8;
constexpr std::uint32_t kInt16 = 3;
constexpr std::uint32_t kInt32 = 5;
constexpr std::uint32_t kCompressed = 15;

std::uint32_t mat_u32_at(const Bytes& bytes, std::size_t offset) {
  if (offset + sizeof(std::uint32_t) > bytes.size()) {
    throw std::runtime_error("the matrix ends too early");
  }
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + offset, sizeof(value));
  return value;
}

Bytes inflated(const std::byte* compressed, std::size_t size) {
  uLongf length = 64UL << 20U;  // more than any of these files holds
  Bytes bytes(length);
  if (uncompress(reinterpret_cast<Bytef*>(bytes.data()),
                 &length,
                 reinterpret_cast<const Bytef*>(compressed),
                 size) != Z_OK) {
    throw std::runtime_error("the matrix cannot be uncompressed");
  }
  bytes.resize(length);
  return bytes;
}

// The next element of a matrix; each starts at a multiple of eight bytes.
struct Element {
  std::uint32_t type = 0;
  std::size_t begin = 0;
  std::size_t size = 0;

  std::size_t end() const { return begin + (size + 7) / 8 * 8; }
};

Element element_at(const Bytes& bytes, std::size_t offset) {
  const Element element{mat_u32_at(bytes, offset), offset + kTag, mat_u32_at(bytes, offset + 4)};
  if (element.begin + element.size > bytes.size()) {
    throw std::runtime_error("the matrix ends too early");
  }
  return element;
}

std::vector<std::int16_t> int16_of(const Bytes& bytes, const Element& element, std::size_t count) {
  if (element.type != kInt16 || element.size != count * sizeof(std::int16_t)) {
    throw std::runtime_error("the matrix is not of int16");
  }
  std::vector<std::int16_t> values(count);
  std::memcpy(values.data(), bytes.data() + element.begin, element.size);
  return values;
}

}  // namespace

ComplexMatrix read_mat_file(const std::string& path) {
  const Bytes file = read_bytes(path);
  const Element whole = element_at(file, kMatHeader);
  if (whole.type != kCompressed) {
    throw std::runtime_error(path + ": not one compressed matrix");
  }
  const Bytes matrix = inflated(file.data() + whole.begin, whole.size);
  const Element flags = element_at(matrix, kTag);
  const Element dimensions = element_at(matrix, flags.end());
  if (dimensions.type != kInt32 || dimensions.size != 2 * sizeof(std::uint32_t)) {
    throw std::runtime_error(path + ": not a matrix");
  }
  ComplexMatrix result;
  result.rows = mat_u32_at(matrix, dimensions.begin);
  result.columns = mat_u32_at(matrix, dimensions.begin + 4);
  const std::size_t count = result.rows * result.columns;
  const Element name = element_at(matrix, dimensions.end());
  const Element real = element_at(matrix, name.end());
  const auto re = int16_of(matrix, real, count);
  const auto im = int16_of(matrix, element_at(matrix, real.end()), count);
  for (std::size_t row = 0; row < result.rows; ++row) {
    for (std::size_t column = 0; column < result.columns; ++column) {
      const std::size_t at = row + column * result.rows;  // column by column in the file
      result.values.emplace_back(re[at], im[at]);
    }
  }
  return result;
}

}  // namespace rayloc::test
