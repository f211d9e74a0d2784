#include <array>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <system_error>
#include <utility>

#include "daemon/site/model/site_tables.h"

namespace rayloc {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kLargestTable = 64 << 20;  // [bytes]; every degree takes 0.5 MB

// The text of a table of gains, or an Error.
Expected<std::string> read_table(const fs::path& file) {
  std::error_code status;
  if (fs::file_size(file, status) > kLargestTable || status) {
    return bad_input(file.string() + " is larger than 64 MB: no table of gains");
  }
  std::ifstream stream(file, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (!stream.is_open() || stream.bad()) {
    return bad_input(file.string() + " cannot be read; may you read it?");
  }
  return text;
}

Expected<AntennaPattern> load_pattern(const fs::path& file) {
  const auto text = read_table(file);
  RAYLOC_TRY(text);
  auto table = AntennaGainTable::parse(*text, file.string());
  RAYLOC_TRY(table);
  return AntennaPattern(std::make_shared<const AntennaGainTable>(*std::move(table)));
}

}  // namespace

AntennaPattern read_pattern(const SiteTable& table) {
  constexpr auto kUsual = AntennaPattern::kHalfWaveDipole;
  const std::optional<std::string> name = table.choice("pattern");
  const std::optional<fs::path> file = table.file("pattern_file");
  if (!file || name) {
    return name ? parse_antenna_pattern(*name).value_or(kUsual) : kUsual;
  }
  auto pattern = load_pattern(*file);
  if (!pattern) {
    table.error_at("pattern_file", "'pattern_file': " + pattern.error().message);
    return kUsual;
  }
  return *std::move(pattern);
}

Polarization read_polarization(const SiteTable& table) {
  return table.choice("polarization").value_or("V") == "H" ? Polarization::kHorizontal
                                                           : Polarization::kVertical;
}

}  // namespace rayloc
