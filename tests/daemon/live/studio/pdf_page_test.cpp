// A page of a PDF as a picture, by the tools of poppler; scripts take their place for faults.
#include "daemon/live/studio/pdf_page.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace rayloc::pdf_page_test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct Sheet {
  std::string size;        // width and height [points], as in the file
  std::string attributes;  // of the page
};

// A PDF with a filled square on each page.
std::string pdf_of(const std::vector<Sheet>& sheets, const std::string& trailer = "") {
  std::vector<std::string> objects{"<</Type/Catalog/Pages 2 0 R>>", ""};
  std::string kids;
  for (const Sheet& sheet : sheets) {
    const std::string content = "1 0 0 rg 20 20 40 40 re f";
    const std::string page = std::to_string(objects.size() + 1);
    kids += page + " 0 R ";
    objects.push_back("<</Type/Page/Parent 2 0 R/MediaBox[0 0 " + sheet.size + "]/Contents " +
                      std::to_string(objects.size() + 2) + " 0 R" + sheet.attributes + ">>");
    objects.push_back("<</Length " + std::to_string(content.size()) + ">>stream\n" + content +
                      "\nendstream");
  }
  objects[1] = "<</Type/Pages/Count " + std::to_string(sheets.size()) + "/Kids[" + kids + "]>>";
  std::string pdf = "%PDF-1.4\n";
  std::string table = "0000000000 65535 f \n";
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const std::string offset = std::to_string(pdf.size());
    table += std::string(10 - offset.size(), '0') + offset + " 00000 n \n";
    pdf += std::to_string(i + 1) + " 0 obj\n" + objects[i] + "\nendobj\n";
  }
  const std::string start = std::to_string(pdf.size());
  const std::string count = std::to_string(objects.size() + 1);
  return pdf + "xref\n0 " + count + "\n" + table + "trailer<</Size " + count + "/Root 1 0 R" +
         trailer + ">>\nstartxref\n" + start + "\n%%EOF\n";
}

const Sheet kSmall = {"288 144", ""};
const Sheet kA4 = {"842 595", ""};

// Once no process runs; with the number of the conversion.
Expected<Json> outcome_of(PdfPage& plan, const Json& started) {
  const std::string number = started.at("number").dump();
  auto state = plan.state(number);
  while (state && state->at("running")) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    state = plan.state(number);
  }
  if (state) {
    (*state)["number"] = started.at("number");
  }
  return state;
}

Expected<Json> read(PdfPage& plan, const std::string& pdf, const std::string& page = "") {
  const auto started = plan.start(pdf, page);
  return started ? outcome_of(plan, *started) : started;
}

std::string refusal_of(PdfPage& plan, const std::string& pdf, const std::string& page = "") {
  const auto result = read(plan, pdf, page);
  return result ? "accepted: " + result->dump() : result.error().message;
}

Expected<std::string> picture_of(PdfPage& plan, const Json& state) {
  return plan.picture(state.at("number").dump());
}

// Width and height in the header of a PNG.
std::pair<int, int> size_of(const std::string& png) {
  const auto number_at = [&](std::size_t at) {
    int number = 0;
    for (std::size_t i = at; i < at + 4; ++i) {
      number = 256 * number + static_cast<unsigned char>(png.at(i));
    }
    return number;
  };
  return png.rfind("\x89PNG", 0) == 0 ? std::pair(number_at(16), number_at(20)) : std::pair(0, 0);
}

class PdfPageTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (access("/usr/bin/pdftoppm", X_OK) != 0) {
      GTEST_SKIP() << "pdftoppm (Debian: poppler-utils) is not installed";
    }
  }
};

TEST_F(PdfPageTest, IsAPictureWithTheSizeOfAPixel) {
  PdfPage plan;
  const auto first = read(plan, pdf_of({kSmall, kA4}));
  ASSERT_TRUE(first) << first.error().message;
  EXPECT_EQ(first->at("page"), 1);
  EXPECT_EQ(first->at("pages"), 2);
  EXPECT_EQ(first->at("remark"), "");
  const auto picture = picture_of(plan, *first);
  ASSERT_TRUE(picture) << picture.error().message;
  const auto [width, height] = size_of(*picture);
  // 4 x 2 inches.
  const double millimetres = first->at("millimetres");
  EXPECT_NEAR(width * millimetres, 101.6, millimetres);
  EXPECT_NEAR(height * millimetres, 50.8, millimetres);
  EXPECT_FALSE(picture_of(plan, *first)) << "it is given once";
  const auto second = read(plan, pdf_of({kSmall, kA4}), "2");
  ASSERT_TRUE(second) << second.error().message;
  const auto other = picture_of(plan, *second);
  ASSERT_TRUE(other) << other.error().message;
  EXPECT_NEAR(size_of(*other).first * second->at("millimetres").get<double>(), 297, 0.2);
}

TEST_F(PdfPageTest, ShowsThePageAsAReaderDoes) {
  PdfPage plan;
  const auto state = read(plan, "\n" + pdf_of({{"842 595", "/CropBox[0 0 288 144]/Rotate 90"}}));
  ASSERT_TRUE(state) << state.error().message;
  const auto picture = picture_of(plan, *state);
  ASSERT_TRUE(picture) << picture.error().message;
  EXPECT_EQ(size_of(*picture), std::pair(300, 600)) << "of the crop box, upright, at 150 dpi";
}

TEST_F(PdfPageTest, ATitleStatesNoSize) {
  PdfPage plan;
  const std::string title = "Plan\\nPages: 7\\nPage    1 size: 10000000 x 10 pts";
  const auto state = read(plan, pdf_of({kSmall}, "/Info<</Title(" + title + ")>>"));
  ASSERT_TRUE(state) << state.error().message;
  EXPECT_EQ(state->at("pages"), 1);
  const auto picture = picture_of(plan, *state);
  ASSERT_TRUE(picture) << picture.error().message;
  EXPECT_EQ(size_of(*picture), std::pair(600, 300)) << "at 150 dpi";
}

TEST_F(PdfPageTest, AHugePageHasFewerDots) {
  PdfPage plan;
  const auto state = read(plan, pdf_of({{"10000000 2000000", ""}}));
  ASSERT_TRUE(state) << state.error().message;
  const auto picture = picture_of(plan, *state);
  ASSERT_TRUE(picture) << picture.error().message;
  const auto [width, height] = size_of(*picture);
  EXPECT_NEAR(width, 6000, 1);
  EXPECT_NEAR(height, 1200, 1);
  EXPECT_NEAR(width * state->at("millimetres").get<double>(), 1e7 / 72 * 25.4, 600);
}

TEST_F(PdfPageTest, InvalidContentIsRefusedWithARemedy) {
  PdfPage plan;
  const std::string pages = refusal_of(plan, pdf_of({kSmall, kA4}), "3");
  EXPECT_NE(pages.find("pages 1 to 2"), std::string::npos) << pages;
  const std::string single = refusal_of(plan, pdf_of({kSmall}), "2");
  EXPECT_NE(single.find("one page"), std::string::npos) << single;
  const std::string locked =
      refusal_of(plan,
                 pdf_of({kSmall},
                        "/Encrypt<</Filter/Standard/V 1/R 2/O<" + std::string(64, '4') + ">/U<" +
                            std::string(64, '5') + ">/P -4>>/ID[<31><31>]"));
  EXPECT_NE(locked.find("password"), std::string::npos) << locked;
  EXPECT_NE(locked.find("PNG"), std::string::npos) << locked;
  for (const std::string& damaged :
       {std::string("%PDF-1.7\n"), pdf_of({}), pdf_of({kSmall}).substr(0, 60)}) {
    const std::string reason = refusal_of(plan, damaged);
    EXPECT_NE(reason.find("cannot be read ("), std::string::npos) << reason;
    EXPECT_NE(reason.find("print it to a new PDF"), std::string::npos) << reason;
  }
}

TEST_F(PdfPageTest, TheSizeOfThePictureIsLimited) {
  PdfPage plan("/usr/bin", {.picture_bytes = 1000});  // what pdfinfo writes is shorter
  const std::string reason = refusal_of(plan, pdf_of({kA4}));
  EXPECT_NE(reason.find("more than 1000 bytes"), std::string::npos) << reason;
}

TEST_F(PdfPageTest, OnlyTheLastConversionHasAnAnswer) {
  PdfPage plan;
  EXPECT_FALSE(plan.state("0"));
  EXPECT_FALSE(plan.picture("0"));
  const auto first = plan.start(pdf_of({kSmall}), "1");
  const auto second = plan.start(pdf_of({kA4}), "1");
  ASSERT_TRUE(first && second);
  EXPECT_FALSE(plan.picture(second->at("number").dump())) << "before it has ended";
  EXPECT_FALSE(plan.state(first->at("number").dump()));
  ASSERT_TRUE(outcome_of(plan, *second));
  EXPECT_FALSE(plan.picture(first->at("number").dump()));
  EXPECT_TRUE(plan.picture(second->at("number").dump()));
  const auto afterwards = plan.state(second->at("number").dump());
  EXPECT_FALSE(afterwards);
}

TEST(PdfPage, RefusesOtherContentAndOtherPagesAtOnce) {
  PdfPage plan("/nowhere");
  EXPECT_NE(refusal_of(plan, "").find("empty"), std::string::npos);
  EXPECT_NE(refusal_of(plan, "\x89PNG").find("no PDF"), std::string::npos);
  EXPECT_NE(refusal_of(plan, std::string(2000, ' ') + "%PDF-1.4").find("no PDF"),
            std::string::npos);
  for (const char* page : {"0", "-1", "x", "1x", " 1", "10000", "99999999999999999999"}) {
    const std::string reason = refusal_of(plan, pdf_of({kSmall}), page);
    EXPECT_NE(reason.find(page), std::string::npos) << reason;
  }
}

TEST(PdfPage, MissingToolsAreReported) {
  PdfPage plan("/nowhere");
  const auto started = plan.start(pdf_of({kSmall}), "1");
  ASSERT_FALSE(started);
  EXPECT_EQ(started.error().kind, ErrorKind::kUnavailable);
  EXPECT_NE(started.error().message.find("poppler-utils"), std::string::npos)
      << started.error().message;
}

// The count of descriptors in this process.
std::ptrdiff_t open_files() {
  return std::distance(fs::directory_iterator("/proc/self/fd"), fs::directory_iterator());
}

class PdfTools : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("rayloc-pdf-tools." + std::to_string(getpid()));
    fs::create_directories(folder_);
    write("pdfinfo", "echo 'Pages: 1'; echo 'Page    1 size: 288 x 144 pts'");
  }
  void TearDown() override { fs::remove_all(folder_); }

  void write(const std::string& tool, const std::string& script) const {
    std::ofstream(folder_ / tool) << "#!/bin/sh\n" << script << "\n";
    fs::permissions(folder_ / tool, fs::perms::owner_all);
  }

  fs::path folder_;
};

TEST_F(PdfTools, ASignalOrATimeLimitIsAnError) {
  PdfPage plan(folder_, {.processor_seconds = 1});
  write("pdftoppm", "kill -SEGV $$");
  const std::string fault = refusal_of(plan, pdf_of({kSmall}));
  EXPECT_NE(fault.find("signal 11"), std::string::npos) << fault;
  write("pdftoppm", "while true; do :; done");
  const std::string slow = refusal_of(plan, pdf_of({kSmall}));
  EXPECT_NE(slow.find("more than 1 s"), std::string::npos) << slow;
}

TEST_F(PdfTools, AConversionHasALimitOfTime) {
  PdfPage plan(folder_, {.conversion = std::chrono::seconds(0)});
  write("pdfinfo", "exec sleep 600");
  const std::ptrdiff_t before = open_files();
  const auto started = plan.start(pdf_of({kSmall}), "1");
  ASSERT_TRUE(started) << started.error().message;
  EXPECT_GT(open_files(), before);
  const auto state = plan.state(started->at("number").dump());
  ASSERT_FALSE(state) << state->dump();
  EXPECT_NE(state.error().message.find("PNG"), std::string::npos) << state.error().message;
  EXPECT_EQ(open_files(), before);
  EXPECT_FALSE(plan.state(started->at("number").dump()));
}

TEST_F(PdfTools, NoFileStaysAfterAnError) {
  PdfPage plan(folder_);
  const std::ptrdiff_t before = open_files();
  write("pdftoppm", "exit 0");
  const auto empty = read(plan, pdf_of({kSmall}));
  ASSERT_TRUE(empty) << empty.error().message;
  EXPECT_GT(open_files(), before);
  EXPECT_FALSE(picture_of(plan, *empty));
  EXPECT_EQ(open_files(), before) << "the picture is empty";
  write("pdftoppm", "exit 1");
  EXPECT_FALSE(read(plan, pdf_of({kSmall})));
  EXPECT_EQ(open_files(), before) << "the second process failed";
  fs::remove(folder_ / "pdfinfo");
  EXPECT_FALSE(read(plan, pdf_of({kSmall})));
  EXPECT_EQ(open_files(), before) << "the first process cannot be started";
}

// Limits of this process for the time of a test.
class SoftLimit {
 public:
  SoftLimit(decltype(RLIMIT_CPU) resource, rlim_t limit) : resource_(resource) {
    getrlimit(resource_, &before_);
    const rlimit both{std::min(limit, before_.rlim_max), before_.rlim_max};
    setrlimit(resource_, &both);
  }
  ~SoftLimit() { setrlimit(resource_, &before_); }
  SoftLimit(const SoftLimit&) = delete;
  SoftLimit& operator=(const SoftLimit&) = delete;

 private:
  decltype(RLIMIT_CPU) resource_;
  rlimit before_{};
};

TEST_F(PdfTools, TheirLimitsAreNeverAboveThoseOfThisProcess) {
  const SoftLimit processor(RLIMIT_CPU, 5000);
  const SoftLimit core(RLIMIT_CORE, RLIM_INFINITY);
  write("pdftoppm", "echo $(ulimit -S -t) $(ulimit -S -c) $(ulimit -H -c) >&2");
  PdfPage lower(folder_, {.processor_seconds = 4000});
  const auto limited = read(lower, pdf_of({kSmall}));
  ASSERT_TRUE(limited) << limited.error().message;
  EXPECT_EQ(limited->at("remark"), "4000 0 0");
  PdfPage higher(folder_, {.processor_seconds = 6000});
  const auto inherited = read(higher, pdf_of({kSmall}));
  ASSERT_TRUE(inherited) << inherited.error().message;
  EXPECT_EQ(inherited->at("remark"), "5000 0 0");
}

TEST_F(PdfTools, ANumberNamesTheConversionOfOneObjectOnly) {
  write("pdftoppm", "echo picture");
  PdfPage first(folder_);
  PdfPage second(folder_);
  const auto of_first = read(first, pdf_of({kSmall}));
  const auto of_second = read(second, pdf_of({kSmall}));
  ASSERT_TRUE(of_first && of_second);
  EXPECT_FALSE(picture_of(second, *of_first));
  EXPECT_TRUE(picture_of(first, *of_first));
  EXPECT_TRUE(picture_of(second, *of_second));
}

TEST_F(PdfTools, TheirFaultsAreErrors) {
  PdfPage plan(folder_);
  write("pdftoppm", "echo 'Syntax Error: no font' >&2; exit 0");
  const auto state = read(plan, pdf_of({kSmall}));
  ASSERT_TRUE(state) << state.error().message;
  EXPECT_EQ(state->at("remark"), "Syntax Error: no font");
  EXPECT_FALSE(picture_of(plan, *state)) << "it is empty";
  for (const char* text : {"",
                           "Pages: 1",
                           "Pages: 1\nPage    1 size: 0 x 144 pts",
                           "Pages: 1\nPage    1 size: 288",
                           "Pages: 1\nPage    1 size: nan x 1 pts",
                           "Pages: 1\nPage    1 size: inf x 1 pts"}) {
    write("pdfinfo", std::string("printf '%s\\n' \"") + text + "\"");
    const std::string reason = refusal_of(plan, pdf_of({kSmall}));
    EXPECT_NE(reason.find("no size"), std::string::npos) << text << ": " << reason;
  }
  fs::remove(folder_ / "pdftoppm");
  write("pdfinfo", "echo 'Pages: 1'; echo 'Page    1 size: 288 x 144 pts'");
  EXPECT_NE(refusal_of(plan, pdf_of({kSmall})).find("poppler-utils"), std::string::npos);
}

}  // namespace
}  // namespace rayloc::pdf_page_test
