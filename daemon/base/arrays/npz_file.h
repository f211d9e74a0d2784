// NpzFile: arrays in one file, readable by numpy.load().
//
//   auto file = NpzFile::create("x.npz");
//   file->add("tau", tau, {tau.size()});
//   auto written = file->close();
//
// References: numpy.lib.format, version 1.0.
#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "engine/base/expected.h"

namespace rayloc {

class NpzFile {
 public:
  // kUnavailable if the file cannot be written. A file that is not closed is removed.
  static Expected<NpzFile> create(const std::string& path);
  ~NpzFile();
  NpzFile(NpzFile&&) noexcept;
  NpzFile& operator=(NpzFile&&) noexcept;

  // `descr`: numpy's description of an element, "'<f8'" or a list of fields;
  // the last axis varies fastest. Write errors are reported by close();
  // nothing is added after one. REQUIRES: as many bytes as the shape needs.
  void add(const std::string& name,
           std::string_view descr,
           std::span<const std::byte> bytes,
           const std::vector<std::size_t>& shape);
  template <typename T>
  void add(const std::string& name,
           const std::vector<T>& values,
           const std::vector<std::size_t>& shape) {
    add(name, descr_of<T>(), std::as_bytes(std::span(values)), shape);
  }
  // Texts, as an array of one axis.
  void add_texts(const std::string& name, const std::vector<std::string>& texts);

  // Finishes the file. Returns an Error for the first failed write.
  Expected<void> close();

 private:
  class Impl;
  explicit NpzFile(std::unique_ptr<Impl> impl);

  template <typename T>
  static constexpr std::string_view descr_of() {
    if constexpr (std::is_same_v<T, double>) {
      return "'<f8'";
    } else if constexpr (std::is_same_v<T, float>) {
      return "'<f4'";
    } else if constexpr (std::is_same_v<T, std::complex<double>>) {
      return "'<c16'";
    } else if constexpr (std::is_same_v<T, std::complex<float>>) {
      return "'<c8'";
    } else if constexpr (std::is_same_v<T, std::uint8_t>) {
      return "'|u1'";
    } else if constexpr (std::is_same_v<T, std::int16_t>) {
      return "'<i2'";
    } else if constexpr (std::is_same_v<T, std::uint32_t>) {
      return "'<u4'";
    } else {
      static_assert(std::is_same_v<T, std::int64_t>, "another row is needed here");
      return "'<i8'";
    }
  }

  std::unique_ptr<Impl> impl_;
};

// True if the value of --out requests arrays.
inline bool is_npz(std::string_view path) { return path.ends_with(".npz"); }

}  // namespace rayloc
