// PdfPage: converts a page of a PDF that a browser sent to a picture, to draw a site over it. A
// browser gives a page no picture of a PDF.
//
// pdfinfo and pdftoppm (Debian: poppler-utils) read the file, as processes with limits of time and
// memory: a PDF comes from outside, and its readers are large. They read and write unnamed files.
// start() and state() never wait for them to end by themselves; a process that is killed is waited
// for (ChildProcess). A limit of time applies to a conversion as a whole, and is checked by
// state(): without it the process and the files stay until the next start() or the end of this
// object.
//
// Thread safety: one thread at a time; the thread that calls start() and state() must outlive it.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "daemon/live/studio/child_process.h"
#include "engine/base/expected.h"

namespace rayloc {

class PdfPage {
 public:
  static constexpr std::size_t kMaxBytes = std::size_t{64} << 20U;  // [bytes] of a PDF

  // Limits of each process, except that of the whole conversion.
  struct Limits {
    std::uint64_t memory_bytes = std::uint64_t{1} << 30U;
    std::uint64_t processor_seconds = 30;
    std::chrono::seconds conversion{60};  // chosen: two processes with their waits
    std::uint64_t picture_bytes = std::uint64_t{16} << 20U;
  };

  // `tools`: the folder of pdfinfo and pdftoppm.
  explicit PdfPage(std::filesystem::path tools = "/usr/bin")
      : PdfPage(std::move(tools), Limits{}) {}
  PdfPage(std::filesystem::path tools, const Limits& limits)
      : tools_(std::move(tools)), limits_(limits) {}

  // Ends the previous conversion and begins one. `page`: a number from 1, as text; empty: 1.
  // Returns {"number"}, which names this conversion among those of all objects. Errors: the content
  // is empty or no PDF, `page` is no number of a page, or the tools are not installed
  // (kUnavailable).
  Expected<nlohmann::ordered_json> start(const std::string& pdf, const std::string& page);
  // {"running": true}, or "running": false with "page", "pages", "millimetres" (on the page, of a
  // pixel of the picture) and "remark" (of the tools; may be empty). Errors: a password is
  // needed, there is no such page, the file cannot be read, a limit was exceeded, or `number` is
  // not the number of the last conversion.
  Expected<nlohmann::ordered_json> state(const std::string& number);
  // The picture as PNG, once.
  Expected<std::string> picture(const std::string& number);

 private:
  using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

  Expected<void> run(const char* tool, const std::vector<std::string>& options);
  Expected<void> check_status(int status) const;
  Expected<void> measure();
  Expected<void> advance();
  // Ends the process and removes the files.
  void forget();
  bool is_current(const std::string& number) const;

  std::filesystem::path tools_;
  Limits limits_;
  int number_ = 0;  // of the last conversion; 0: none
  int page_ = 1;
  int pages_ = 0;  // 0: not known yet
  double dots_per_inch_ = 0;
  std::chrono::steady_clock::time_point deadline_;
  File pdf_{nullptr, &std::fclose};
  File output_{nullptr, &std::fclose};     // of the process
  std::unique_ptr<ChildProcess> process_;  // null: none runs
};

}  // namespace rayloc
