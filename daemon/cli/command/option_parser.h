// OptionParser: the command line of our programs, by CLI11. Only option_parser.cpp includes that
// library, since it adds 15 to 30 s to the compilation of a source.
//
// Names and rules are CLI11's: "--json,-j" is an option, "FILE" a
// positional argument; a given value is written to the variable when
// the command line is parsed, so the variable must live until then.
//
// Thread safety: none.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "daemon/cli/command/command_description.h"

namespace CLI {  // NOLINT(readability-identifier-naming): the library's own name
class Option;
}

namespace rayloc::cli {

// Allowed ranges of the values of an option.
struct IntegerRange {
  int least = 0;
  int most = 0;
};
struct RealRange {
  double least = 0.0;
  double most = 0.0;
};
struct AnyPositive {};
struct AnyNotNegative {};
using ValueCheck =
    std::variant<IntegerRange, RealRange, AnyPositive, AnyNotNegative, std::vector<std::string>>;

inline ValueCheck in_range(int least, int most) { return IntegerRange{least, most}; }
inline ValueCheck in_range(double least, double most) { return RealRange{least, most}; }
inline ValueCheck positive() { return AnyPositive{}; }
inline ValueCheck not_negative() { return AnyNotNegative{}; }
inline ValueCheck one_of(std::vector<std::string> values) { return values; }

// An option under declaration; its parser owns it.
class ParserOption {
 public:
  explicit ParserOption(CLI::Option* option) : option_(option) {}

  ParserOption* required();
  ParserOption* check(const ValueCheck& check);
  // --help shows the current value of the variable.
  ParserOption* capture_default_str();
  ParserOption* description(const std::string& text);
  ParserOption* needs(const ParserOption* other);
  ParserOption* excludes(const ParserOption* other);
  // False: one value per option name.
  ParserOption* allow_extra_args(bool allow);

 private:
  CLI::Option* option_;
};

class OptionParser {
 public:
  // `version`: the text printed by --version.
  OptionParser(const std::string& description, const std::string& name, const std::string& version);
  ~OptionParser();
  OptionParser(const OptionParser&) = delete;
  OptionParser& operator=(const OptionParser&) = delete;

  // Value: std::string, bool, an integer, double, a std::optional or a std::vector of one of these;
  // option_parser.cpp instantiates them, and any other fails to link.
  template <typename Value>
  ParserOption* add_option(const std::string& names, Value& value, const std::string& description);
  ParserOption* add_flag(const std::string& names, bool& value, const std::string& description);
  // Returns an option that was added. REQUIRES: it exists.
  ParserOption* get_option(const std::string& name);

  // Text at the end of --help.
  void footer(const std::string& text);
  std::string get_footer() const;

  OptionParser* add_subcommand(const std::string& name, const std::string& summary);
  void require_subcommand(int count);
  // Called if this subcommand was given.
  void callback(std::function<void()> call);
  bool parsed() const;

  // Returns an exit status if the program is to end at once: after --help and --version, which are
  // printed, or after an error, which is reported on standard error.
  std::optional<int> parse(int argc, const char* const* argv);

  Command describe() const;

 private:
  class Impl;
  explicit OptionParser(std::unique_ptr<Impl> impl);

  std::unique_ptr<Impl> impl_;
};

}  // namespace rayloc::cli
