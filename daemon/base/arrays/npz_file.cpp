#include "daemon/base/arrays/npz_file.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include <minizip/zip.h>

namespace rayloc {
namespace {

// Bytes per call of minizip, whose counts have 32 bits.
constexpr std::size_t kMaxChunk = std::size_t{1} << 30U;
// Size from which a member needs the fields of zip64 [bytes]; below the limit of 2^32.
constexpr std::size_t kBigMember = std::size_t{3} << 30U;

// Magic, version 1.0, length, and a dictionary that ends with a new line at a multiple of 64 bytes.
std::string npy_header(std::string_view descr, const std::vector<std::size_t>& shape) {
  std::string text = "{'descr': " + std::string(descr) + ", 'fortran_order': False, 'shape': (";
  for (const std::size_t count : shape) {
    text += std::to_string(count) + ", ";
  }
  if (shape.size() > 1) {
    text.resize(text.size() - 2);
  }
  text += "), }";
  constexpr std::size_t kBefore = 10;
  constexpr std::size_t kMultiple = 64;
  while ((kBefore + text.size() + 1) % kMultiple != 0) {
    text += ' ';
  }
  text += '\n';
  std::string header("\x93NUMPY\x01\x00", 8);
  header += static_cast<char>(text.size() & 0xffU);
  header += static_cast<char>(text.size() >> 8U);
  return header + text;
}

}  // namespace

class NpzFile::Impl {
 public:
  explicit Impl(std::string path) : path_(std::move(path)), file_(zipOpen64(path_.c_str(), 0)) {}
  ~Impl() {
    if (file_ != nullptr) {
      zipClose(file_, nullptr);
      std::remove(path_.c_str());
    }
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  bool is_open() const { return file_ != nullptr; }

  void add(const std::string& name, const std::string& header, std::span<const std::byte> bytes) {
    if (written_) {
      written_ = add_member(name, header, bytes);
    }
  }

  // The destructor removes an incomplete file.
  Expected<void> close() {
    if (!written_) {
      return written_;
    }
    const int closed = zipClose(std::exchange(file_, nullptr), nullptr);
    if (closed != ZIP_OK) {
      std::remove(path_.c_str());
      return failed();
    }
    return {};
  }

 private:
  Expected<void> add_member(const std::string& name,
                            const std::string& header,
                            std::span<const std::byte> bytes) {
    const zip_fileinfo info{};
    constexpr int kLevel = 1;  // of zlib, 1 to 9: higher levels gain little with noisy numbers
    if (zipOpenNewFileInZip64(file_,
                              (name + ".npy").c_str(),
                              &info,
                              nullptr,
                              0,
                              nullptr,
                              0,
                              nullptr,
                              Z_DEFLATED,
                              kLevel,
                              bytes.size() > kBigMember ? 1 : 0) != ZIP_OK) {
      return failed();
    }
    RAYLOC_TRY(write(std::as_bytes(std::span(header))));
    RAYLOC_TRY(write(bytes));
    return zipCloseFileInZip(file_) == ZIP_OK ? Expected<void>() : failed();
  }

  Expected<void> write(std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
      const std::size_t count = std::min(bytes.size(), kMaxChunk);
      if (zipWriteInFileInZip(file_, bytes.data(), static_cast<unsigned>(count)) != ZIP_OK) {
        return failed();
      }
      bytes = bytes.subspan(count);
    }
    return {};
  }

  Expected<void> failed() const {
    return make_error(ErrorKind::kUnavailable,
                      path_ + ": cannot be written to its end; is the disk full?");
  }

  std::string path_;
  zipFile file_;
  Expected<void> written_;  // result of the writes; an Error stays
};

Expected<NpzFile> NpzFile::create(const std::string& path) {
  auto impl = std::make_unique<Impl>(path);
  if (!impl->is_open()) {
    return make_error(ErrorKind::kUnavailable, path + ": cannot be written; choose another --out");
  }
  return NpzFile(std::move(impl));
}

NpzFile::NpzFile(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
NpzFile::~NpzFile() = default;
NpzFile::NpzFile(NpzFile&&) noexcept = default;
NpzFile& NpzFile::operator=(NpzFile&&) noexcept = default;

void NpzFile::add(const std::string& name,
                  std::string_view descr,
                  std::span<const std::byte> bytes,
                  const std::vector<std::size_t>& shape) {
  impl_->add(name, npy_header(descr, shape), bytes);
}

void NpzFile::add_texts(const std::string& name, const std::vector<std::string>& texts) {
  std::size_t longest = 1;  // numpy has no zero-length text type
  for (const std::string& text : texts) {
    longest = std::max(longest, text.size());
  }
  std::string bytes;
  for (const std::string& text : texts) {
    bytes += text + std::string(longest - text.size(), '\0');
  }
  add(name, "'|S" + std::to_string(longest) + "'", std::as_bytes(std::span(bytes)), {texts.size()});
}

Expected<void> NpzFile::close() { return impl_->close(); }

}  // namespace rayloc
