#include "engine/scene/read/ply_body.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

#include "engine/base/number_text.h"

namespace rayloc {
namespace {

std::size_t size_of(PlyType type) {
  switch (type) {
    case PlyType::kInt8:
    case PlyType::kUint8:
      return 1;
    case PlyType::kInt16:
    case PlyType::kUint16:
      return 2;
    case PlyType::kInt32:
    case PlyType::kUint32:
    case PlyType::kFloat32:
      return 4;
    case PlyType::kFloat64:
      break;
  }
  return 8;
}

}  // namespace

PlyBody::PlyBody(std::string_view bytes, const PlyHeader& header)
    : bytes_(bytes), encoding_(header.encoding), at_(header.size), line_(header.lines + 1) {
  // Blanks, and the padding of a last block: zeros, the end mark of DOS.
  constexpr std::string_view kFill{" \t\r\n\0\x1a", 6};
  const std::size_t last = bytes.find_last_not_of(kFill);
  end_ = last == std::string_view::npos ? 0 : last + 1;
}

bool PlyBody::is_at_end() const { return at_ >= end_; }

std::string PlyBody::place() const {
  return is_text() ? ":" + std::to_string(line_) : ": byte " + std::to_string(at_);
}

std::optional<double> PlyBody::next_text() {
  begins_line_ = at_ == 0 || bytes_[at_ - 1] == '\n';
  while (at_ < bytes_.size() && kPlyBlank.find(bytes_[at_]) != std::string_view::npos) {
    const bool ends_line = bytes_[at_] == '\n';
    line_ += ends_line ? 1U : 0U;
    begins_line_ = begins_line_ || ends_line;
    ++at_;
  }
  std::string_view rest = bytes_.substr(at_);
  const auto value = read_number(rest);
  if (!rest.empty() && kPlyBlank.find(rest[0]) == std::string_view::npos) {
    return std::nullopt;  // "1,5" and "4m" are not numbers
  }
  text_ = bytes_.substr(at_, bytes_.size() - rest.size() - at_);
  at_ = bytes_.size() - rest.size();
  return value;
}

template <typename T>
double PlyBody::decode() {
  std::array<char, sizeof(T)> raw;
  std::memcpy(raw.data(), bytes_.data() + at_, sizeof(T));
  if ((encoding_ == PlyEncoding::kBigEndian) != (std::endian::native == std::endian::big)) {
    std::reverse(raw.begin(), raw.end());
  }
  at_ += sizeof(T);
  return static_cast<double>(std::bit_cast<T>(raw));
}

std::optional<double> PlyBody::next_binary(PlyType type) {
  if (bytes_left() < size_of(type)) {
    return std::nullopt;
  }
  switch (type) {
    case PlyType::kInt8:
      return decode<std::int8_t>();
    case PlyType::kUint8:
      return decode<std::uint8_t>();
    case PlyType::kInt16:
      return decode<std::int16_t>();
    case PlyType::kUint16:
      return decode<std::uint16_t>();
    case PlyType::kInt32:
      return decode<std::int32_t>();
    case PlyType::kUint32:
      return decode<std::uint32_t>();
    case PlyType::kFloat32:
      return decode<float>();
    case PlyType::kFloat64:
      break;
  }
  return decode<double>();
}

}  // namespace rayloc
