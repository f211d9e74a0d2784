// PolledReader: work that follows input at a file descriptor, in short steps that do not wait.
#pragma once

namespace rayloc {

class PolledReader {
 public:
  virtual ~PolledReader() = default;
  // The descriptor that is readable when there is input; -1: none at present.
  virtual int descriptor() const = 0;
  // Takes the input that is there, a bounded part of it, or notes that there is none. False: it has
  // ended, and is not called again.
  virtual bool read_once() = 0;
  // More input may wait for which the descriptor is not readable.
  virtual bool may_have_more() const = 0;
};

}  // namespace rayloc
