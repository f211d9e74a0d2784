#include "daemon/lab/simulate/impairments.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rayloc::impairments_test {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

const std::filesystem::path kFile = "radio.toml";

std::string errors_of(std::string_view text) {
  const auto impairments = parse_impairments(text, kFile);
  return impairments ? "" : impairments.error().message;
}

TEST(Impairments, AnEmptyFileMeansTheDefaults) {
  const auto read = parse_impairments("", kFile);
  ASSERT_TRUE(read);
  for (const ImpairmentKey& key : impairment_keys()) {
    EXPECT_EQ(impairment_text(*read, key), impairment_text(default_impairments(), key)) << key.key;
  }
}

// Every key of the table is read back into the member from which its text was written.
TEST(Impairments, EveryKeyReadsBackTheTextThatIsWritten) {
  Impairments stated = no_impairments();
  std::string text;
  double number = 1.0;
  for (const ImpairmentKey& key : impairment_keys()) {
    if (const auto* flag = std::get_if<bool Impairments::*>(&key.member)) {
      stated.** flag = true;
    } else {
      number += 1.0;
      stated.*std::get<double Impairments::*>(key.member) = number / 64.0;
    }
    text += std::string(key.key) + " = " + impairment_text(stated, key) + "\n";
  }
  const auto read = parse_impairments(text, kFile);
  ASSERT_TRUE(read) << read.error().message;
  for (const ImpairmentKey& key : impairment_keys()) {
    EXPECT_EQ(impairment_text(*read, key), impairment_text(stated, key)) << key.key;
  }
}

TEST(Impairments, StartFromTheirBase) {
  const auto read = parse_impairments("base = \"none\"\nsnr_db = 20", kFile);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->snr_db, 20.0);
  EXPECT_FALSE(read->random_phase);
  EXPECT_EQ(read->delay_max_ns, 0.0);
  EXPECT_EQ(parse_impairments("snr_db = 20", kFile)->delay_max_ns, 350.0);
}

TEST(Impairments, NameThePlaceOfAMistake) {
  EXPECT_THAT(errors_of("\nsnr = 20"), StartsWith("radio.toml:2:1: unknown key 'snr'"));
  EXPECT_THAT(errors_of("snr = 20"), HasSubstr("snr_db"));
  EXPECT_THAT(errors_of("retry_share = 1.5"), StartsWith("radio.toml:1:15: "));
  EXPECT_THAT(errors_of("random_phase = 1"), StartsWith("radio.toml:1:16: "));
  EXPECT_THAT(errors_of("base = \"all\""), StartsWith("radio.toml:1:8: "));
}

TEST(Impairments, ADelayRangeIsNotUpsideDown) {
  EXPECT_THAT(errors_of("delay_max_ns = 40"), StartsWith("radio.toml:1:16: 'delay_max_ns' is 40"));
}

TEST(Impairments, TheHelpNamesEveryKeyAndDefault) {
  EXPECT_THAT(impairments_help(), HasSubstr("delay_outlier_share = 0.02  # share of frames"));
  for (const ImpairmentKey& key : impairment_keys()) {
    EXPECT_THAT(impairments_help(), HasSubstr(std::string(key.key) + " = "));
  }
}

}  // namespace
}  // namespace rayloc::impairments_test
