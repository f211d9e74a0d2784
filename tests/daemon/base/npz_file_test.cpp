// The format as numpy.lib.format describes it, read with minizip.
#include "daemon/base/arrays/npz_file.h"

#include <unistd.h>

#include <array>
#include <complex>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <minizip/unzip.h>

namespace rayloc::npz_file_test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

// A member of an archive: the dictionary of its header, and the bytes of its elements.
struct Member {
  std::string dictionary;
  std::string bytes;
};

std::string content(const std::string& path, const std::string& name) {
  std::string text;
  const unzFile file = unzOpen64(path.c_str());
  EXPECT_NE(file, nullptr);
  if (unzLocateFile(file, name.c_str(), 1) == UNZ_OK && unzOpenCurrentFile(file) == UNZ_OK) {
    std::array<char, 4096> part{};
    for (int count = 0; (count = unzReadCurrentFile(file, part.data(), part.size())) > 0;) {
      text.append(part.data(), static_cast<std::size_t>(count));
    }
    EXPECT_EQ(unzCloseCurrentFile(file), UNZ_OK) << "checksum";
  }
  unzClose(file);
  return text;
}

Member read(const std::string& path, const std::string& name) {
  const std::string text = content(path, name);
  constexpr std::size_t kFixed = 10;
  if (text.size() < kFixed || text.substr(0, 8) != std::string("\x93NUMPY\x01\x00", 8)) {
    ADD_FAILURE() << name << " is no array of version 1.0";
    return {};
  }
  const std::size_t length =
      static_cast<unsigned char>(text[8]) + 256U * static_cast<unsigned char>(text[9]);
  EXPECT_EQ((kFixed + length) % 64, 0U) << "numpy aligns the elements";
  EXPECT_EQ(text.at(kFixed + length - 1), '\n');
  return {text.substr(kFixed, length), text.substr(kFixed + length)};
}

std::string path_of_test() {
  return ::testing::TempDir() + "/npz-" + std::to_string(::getpid()) + "-" +
         ::testing::UnitTest::GetInstance()->current_test_info()->name() + ".npz";
}

TEST(NpzFile, HoldsElementsWithTypeAndShape) {
  const std::string path = path_of_test();
  const std::vector<double> values{1.0, -2.5, 3.0, 4.0, 5.0, 6.0};
  const std::vector<std::complex<float>> gains{{1.0F, -1.0F}};
  auto file = NpzFile::create(path);
  ASSERT_TRUE(file) << file.error().message;
  file->add("values", values, {2, 3});
  file->add("gains", gains, {1});
  ASSERT_TRUE(file->close());

  const Member matrix = read(path, "values.npy");
  EXPECT_THAT(matrix.dictionary,
              HasSubstr("{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }"));
  ASSERT_EQ(matrix.bytes.size(), values.size() * sizeof(double));
  EXPECT_EQ(std::memcmp(matrix.bytes.data(), values.data(), matrix.bytes.size()), 0);

  const Member vector = read(path, "gains.npy");
  EXPECT_THAT(vector.dictionary, HasSubstr("'<c8'"));
  EXPECT_THAT(vector.dictionary, HasSubstr("'shape': (1, )")) << "a tuple of Python, not a number";
  EXPECT_EQ(vector.bytes.size(), sizeof(std::complex<float>));
  fs::remove(path);
}

TEST(NpzFile, PadsTextsToTheLongest) {
  const std::string path = path_of_test();
  auto file = NpzFile::create(path);
  ASSERT_TRUE(file) << file.error().message;
  file->add_texts("names", {"ap1", "", "kitchen"});
  file->add_texts("none", {""});
  ASSERT_TRUE(file->close());
  const Member names = read(path, "names.npy");
  EXPECT_THAT(names.dictionary, HasSubstr("'|S7'"));
  EXPECT_EQ(names.bytes, std::string("ap1\0\0\0\0\0\0\0\0\0\0\0kitchen", 21));
  EXPECT_THAT(read(path, "none.npy").dictionary, HasSubstr("'|S1'")) << "numpy has no '|S0'";
  fs::remove(path);
}

TEST(NpzFile, RemovesAFileThatIsNotClosed) {
  const std::string path = path_of_test();
  {
    auto file = NpzFile::create(path);
    ASSERT_TRUE(file) << file.error().message;
    file->add("x", std::vector<double>{1.0}, {1});
    EXPECT_TRUE(fs::exists(path));
  }
  EXPECT_FALSE(fs::exists(path));
}

TEST(NpzFile, ReportsAPathThatCannotBeWritten) {
  const auto file = NpzFile::create("/nonexistent/x.npz");
  ASSERT_FALSE(file);
  EXPECT_EQ(file.error().kind, ErrorKind::kUnavailable);
}

TEST(NpzFile, IsChosenByTheEndOfItsName) {
  EXPECT_TRUE(is_npz("a.npz"));
  EXPECT_FALSE(is_npz("a.npz.json"));
  EXPECT_FALSE(is_npz("-"));
}

}  // namespace
}  // namespace rayloc::npz_file_test
