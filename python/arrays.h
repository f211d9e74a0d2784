// Numpy arrays over memory owned by C++: no value is copied.
#pragma once

#include <complex>
#include <memory>
#include <utility>
#include <vector>

#include <pybind11/complex.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

namespace rayloc::python {

using Shape = std::vector<pybind11::ssize_t>;

// A read-only view of the memory of `owner`, which lives as long as the array does.
// `strides` [bytes].
template <typename T>
pybind11::array_t<T> view_of(const T* first,
                             const Shape& shape,
                             const Shape& strides,
                             const pybind11::handle& owner) {
  pybind11::array_t<T> array(shape, strides, first, owner);
  array.attr("flags").attr("writeable") = false;
  return array;
}

// An array that takes ownership of the values; the caller may write into it.
template <typename T>
pybind11::array_t<T> array_of(std::vector<T>&& values, const Shape& shape) {
  auto kept = std::make_unique<std::vector<T>>(std::move(values));
  T* first = kept->data();
  const pybind11::capsule owner(kept.get(),
                                [](void* them) { delete static_cast<std::vector<T>*>(them); });
  static_cast<void>(kept.release());
  return pybind11::array_t<T>(shape, first, owner);
}

inline pybind11::ssize_t size_of(std::size_t count) {
  return static_cast<pybind11::ssize_t>(count);
}

}  // namespace rayloc::python
