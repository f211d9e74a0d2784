#include "daemon/live/studio/pdf_page.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <vector>

#include <spdlog/fmt/fmt.h>
#include <nlohmann/json.hpp>

namespace rayloc {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMillimetresPerInch = 25.4;
constexpr double kPointsPerInch = 72.0;
constexpr double kDotsPerInch = 150.0;  // chosen: at 1:100 a pixel is 17 mm of the building
constexpr double kMaxSide = 6000.0;     // [pixels], chosen: 150 dpi of a page of 1 m
constexpr int kMaxPage = 9999;
constexpr std::size_t kHeadBytes = 1024;  // readers accept a PDF that begins within these
constexpr std::string_view kRemedy = "export the page as PNG or JPEG, and take that";
constexpr const char* kInfo = "pdfinfo";
constexpr const char* kDraw = "pdftoppm";

// From its beginning: the offset is shared with a process.
std::string content_of(std::FILE* file) {
  struct stat known {};
  if (file == nullptr || fstat(fileno(file), &known) != 0) {
    return "";
  }
  std::string text(static_cast<std::size_t>(known.st_size), '\0');
  std::size_t got = 0;
  while (got < text.size()) {
    const ssize_t part =
        pread(fileno(file), text.data() + got, text.size() - got, static_cast<off_t>(got));
    if (part <= 0) {
      break;
    }
    got += static_cast<std::size_t>(part);
  }
  text.resize(got);
  return text;
}

// Unique in this process, so that no number names a conversion of another object.
int next_number() {
  static std::atomic<int> last{0};
  return ++last;
}

// The text behind `key` in the last such line of pdfinfo; empty: there is none. A title of several
// lines, which may look the same, is written before them.
std::string_view value_of(std::string_view text, std::string_view key) {
  std::string_view value;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line = text.substr(at, end - at);
    if (line.starts_with(key)) {
      value = line.substr(key.size());
    }
    at = end + 1;
  }
  return value;
}

// The first line that is not empty.
std::string first_line(const std::string& text) {
  const std::size_t begin = std::min(text.find_first_not_of('\n'), text.size());
  return text.substr(begin, text.find('\n', begin) - begin);
}

}  // namespace

bool PdfPage::is_current(const std::string& number) const {
  return number_ > 0 && number == std::to_string(number_);
}

Expected<Json> PdfPage::start(const std::string& pdf, const std::string& page) {
  if (pdf.empty()) {
    return bad_input("it is empty; export the plan again");
  }
  if (std::string_view(pdf).substr(0, kHeadBytes).find("%PDF-") == std::string_view::npos) {
    return bad_input(
        "it is no PDF: it does not begin with %PDF-; export the plan as PDF, PNG or "
        "JPEG");
  }
  int wanted = 1;
  const char* const end = page.data() + page.size();
  const auto read = std::from_chars(page.data(), end, wanted);
  if (!page.empty() && (read.ec != std::errc() || read.ptr != end)) {
    wanted = 0;
  }
  if (wanted < 1 || wanted > kMaxPage) {
    return bad_input(
        fmt::format("there is no page '{}'; write a number from 1 to {}", page, kMaxPage));
  }
  forget();
  number_ = next_number();
  page_ = wanted;
  pages_ = 0;
  deadline_ = std::chrono::steady_clock::now() + limits_.conversion;
  pdf_ = File(std::tmpfile(), &std::fclose);
  if (!pdf_ || std::fwrite(pdf.data(), 1, pdf.size(), pdf_.get()) != pdf.size() ||
      std::fflush(pdf_.get()) != 0) {
    const int error = errno;
    forget();
    return make_error(ErrorKind::kUnavailable,
                      std::string("it cannot be kept while it is read: ") + std::strerror(error));
  }
  if (auto begun = run(kInfo, {"-f", "1", "-l", std::to_string(page_), "-"}); !begun) {
    forget();
    return tl::make_unexpected(std::move(begun).error());
  }
  return Json{{"number", number_}};
}

Expected<void> PdfPage::run(const char* tool, const std::vector<std::string>& options) {
  const std::filesystem::path program = tools_ / tool;
  if (access(program.c_str(), X_OK) != 0) {
    return make_error(ErrorKind::kUnavailable,
                      fmt::format("{} is not installed here; install it (apt-get install "
                                  "poppler-utils), or {}",
                                  program.string(),
                                  kRemedy));
  }
  output_ = File(std::tmpfile(), &std::fclose);
  if (!output_ || lseek(fileno(pdf_.get()), 0, SEEK_SET) != 0) {
    return make_error(
        ErrorKind::kUnavailable,
        std::string("a file for its picture cannot be made: ") + std::strerror(errno));
  }
  auto process = ChildProcess::start(program,
                                     options,
                                     {.input = fileno(pdf_.get()),
                                      .output = fileno(output_.get()),
                                      .memory_bytes = limits_.memory_bytes,
                                      .processor_seconds = limits_.processor_seconds,
                                      .file_bytes = limits_.picture_bytes});
  RAYLOC_TRY(process);
  process_ = *std::move(process);
  return {};
}

Expected<void> PdfPage::check_status(int status) const {
  if (status == 0) {
    return {};
  }
  const std::string errors = process_->errors();
  if (status == ChildProcess::kCannotStart) {
    return make_error(ErrorKind::kUnavailable, first_line(errors));
  }
  if (errors.find("Incorrect password") != std::string::npos) {
    return bad_input(fmt::format(
        "it needs a password; save it without one (qpdf --decrypt does), or {}", kRemedy));
  }
  std::string reason = first_line(errors);
  if (status == ChildProcess::kBySignal + SIGXCPU) {
    reason = fmt::format("it takes more than {} s of processor time", limits_.processor_seconds);
  } else if (status == ChildProcess::kBySignal + SIGXFSZ) {
    reason = fmt::format("its picture takes more than {} bytes", limits_.picture_bytes);
  } else if (status > ChildProcess::kBySignal) {
    reason = fmt::format("signal {} ended its reader, which may use {} bytes of memory",
                         status - ChildProcess::kBySignal,
                         limits_.memory_bytes);
  }
  return bad_input(
      fmt::format("it cannot be read ({}); print it to a new PDF, or {}", reason, kRemedy));
}

// The count of pages, and the resolution from the size of the page.
Expected<void> PdfPage::measure() {
  const std::string text = content_of(output_.get());
  pages_ = std::atoi(std::string(value_of(text, "Pages:")).c_str());
  if (page_ > pages_ && pages_ > 0) {
    return bad_input(pages_ == 1
                         ? fmt::format("it has one page, and no page {}", page_)
                         : fmt::format("it has pages 1 to {}, and no page {}", pages_, page_));
  }
  const std::string size(value_of(text, fmt::format("Page {:4} size:", page_)));
  char* next = nullptr;
  const double width = std::strtod(size.c_str(), &next);
  const double height = *next == '\0' ? 0 : std::strtod(next + std::strspn(next, " x"), nullptr);
  const double longest = std::max(width, height);  // in either orientation
  if (!(std::min(width, height) > 0) || !std::isfinite(longest)) {
    return bad_input(fmt::format("page {} states no size; {}", page_, kRemedy));
  }
  dots_per_inch_ = std::min(kDotsPerInch, kMaxSide * kPointsPerInch / longest);
  return {};
}

// After a process has ended: the next one, or none.
Expected<void> PdfPage::advance() {
  RAYLOC_TRY(check_status(*process_->status()));
  if (pages_ > 0) {
    return {};
  }
  RAYLOC_TRY(measure());
  const std::string page = std::to_string(page_);
  return run(kDraw,
             {"-f",
              page,
              "-l",
              page,
              "-r",
              fmt::format("{:.9g}", dots_per_inch_),
              "-cropbox",
              "-png",
              "-singlefile",
              "-"});
}

Expected<Json> PdfPage::state(const std::string& number) {
  if (!is_current(number)) {
    return bad_input("another plan was read meanwhile; take the file again");
  }
  if (!process_) {
    return bad_input("its reading has ended; take the file again");
  }
  if (!process_->status()) {
    if (std::chrono::steady_clock::now() < deadline_) {
      return Json{{"running", true}};
    }
    forget();
    return bad_input(fmt::format("it is not read after {} s; print it to a new PDF, or {}",
                                 limits_.conversion.count(),
                                 kRemedy));
  }
  const bool is_drawn = pages_ > 0;
  if (const auto advanced = advance(); !advanced) {
    forget();
    return tl::make_unexpected(advanced.error());
  }
  if (!is_drawn) {
    return Json{{"running", true}};
  }
  return Json{{"running", false},
              {"page", page_},
              {"pages", pages_},
              {"millimetres", kMillimetresPerInch / dots_per_inch_},
              {"remark", first_line(process_->errors())}};
}

Expected<std::string> PdfPage::picture(const std::string& number) {
  const bool has_ended = is_current(number) && process_ && pages_ > 0 && process_->status() == 0;
  std::string bytes = has_ended ? content_of(output_.get()) : "";
  if (has_ended) {
    forget();
  }
  if (bytes.empty()) {
    return bad_input("there is no picture of it; take the file again");
  }
  return bytes;
}

void PdfPage::forget() {
  process_.reset();
  pdf_.reset();
  output_.reset();
}

}  // namespace rayloc
