#include "daemon/cli/command/option_parser.h"

#include <cstddef>
#include <deque>
#include <type_traits>
#include <utility>

#include <CLI/CLI.hpp>

#include "daemon/base/exit_status.h"

namespace rayloc::cli {
namespace {

CLI::Validator validator(const ValueCheck& check) {
  return std::visit(
      [](const auto& rule) -> CLI::Validator {
        using Rule = std::decay_t<decltype(rule)>;
        if constexpr (std::is_same_v<Rule, AnyPositive>) {
          return CLI::PositiveNumber;
        } else if constexpr (std::is_same_v<Rule, AnyNotNegative>) {
          return CLI::NonNegativeNumber;
        } else if constexpr (std::is_same_v<Rule, std::vector<std::string>>) {
          return CLI::IsMember(rule);
        } else {
          return CLI::Range(rule.least, rule.most);
        }
      },
      check);
}

// CLI11 reports the values of IsMember() only in the option's type: "TEXT:{device,person,all}".
std::vector<std::string> choices_of(const std::string& type) {
  std::vector<std::string> choices;
  const std::size_t begin = type.find(":{");
  const std::size_t end = type.find('}', begin == std::string::npos ? 0 : begin);
  if (begin == std::string::npos || end == std::string::npos) {
    return choices;
  }
  for (std::size_t at = begin + 2; at < end;) {
    const std::size_t comma = std::min(type.find(',', at), end);
    choices.push_back(type.substr(at, comma - at));
    at = comma + 1;
  }
  return choices;
}

CommandOption describe_option(const CLI::Option& option) {
  CommandOption described;
  for (const std::string& name : option.get_lnames()) {
    described.names.push_back("--" + name);
  }
  for (const std::string& name : option.get_snames()) {
    described.names.push_back("-" + name);
  }
  const bool flag = option.get_type_size_max() == 0;
  if (!flag) {
    const std::string type = option.get_type_name();
    described.value =
        option.get_positional() ? option.get_name(true) : type.substr(0, type.find(':'));
    described.choices = choices_of(type);
    described.preset = option.get_default_str();
  }
  described.description = option.get_description();
  described.required = option.get_required();
  described.repeated = option.get_expected_max() > 1;
  return described;
}

Command describe_app(const CLI::App& app) {
  Command command;
  command.name = app.get_name();
  command.summary = app.get_description();
  command.notes = app.get_footer();
  for (const CLI::Option* option : app.get_options()) {
    (option->get_positional() ? command.arguments : command.options)
        .push_back(describe_option(*option));
  }
  for (const CLI::App* sub : app.get_subcommands({})) {
    command.commands.push_back(describe_app(*sub));
  }
  return command;
}

}  // namespace

ParserOption* ParserOption::required() {
  option_->required();
  return this;
}
ParserOption* ParserOption::check(const ValueCheck& check) {
  option_->check(validator(check));
  return this;
}
ParserOption* ParserOption::capture_default_str() {
  option_->capture_default_str();
  return this;
}
ParserOption* ParserOption::description(const std::string& text) {
  option_->description(text);
  return this;
}
ParserOption* ParserOption::needs(const ParserOption* other) {
  option_->needs(other->option_);
  return this;
}
ParserOption* ParserOption::excludes(const ParserOption* other) {
  option_->excludes(other->option_);
  return this;
}
ParserOption* ParserOption::allow_extra_args(bool allow) {
  option_->allow_extra_args(allow);
  return this;
}

class OptionParser::Impl {
 public:
  explicit Impl(CLI::App& app) : app_(&app) {}
  Impl(const std::string& description, const std::string& name)
      : own_(std::make_unique<CLI::App>(description, name)), app_(own_.get()) {}

  CLI::App& app() const { return *app_; }
  ParserOption* keep(CLI::Option* option) { return &options_.emplace_back(option); }
  OptionParser* keep(std::unique_ptr<OptionParser> parser) {
    return subcommands_.emplace_back(std::move(parser)).get();
  }

 private:
  std::unique_ptr<CLI::App> own_;  // null for a subcommand
  CLI::App* app_;
  std::deque<ParserOption> options_;
  std::vector<std::unique_ptr<OptionParser>> subcommands_;
};

OptionParser::OptionParser(const std::string& description,
                           const std::string& name,
                           const std::string& version)
    : impl_(std::make_unique<Impl>(description, name)) {
  impl_->app().set_version_flag("--version", version);
}
OptionParser::OptionParser(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
OptionParser::~OptionParser() = default;

template <typename Value>
ParserOption* OptionParser::add_option(const std::string& names,
                                       Value& value,
                                       const std::string& description) {
  return impl_->keep(impl_->app().add_option(names, value, description));
}

template ParserOption* OptionParser::add_option(const std::string&, int&, const std::string&);
template ParserOption* OptionParser::add_option(const std::string&, double&, const std::string&);
template ParserOption* OptionParser::add_option(const std::string&,
                                                std::string&,
                                                const std::string&);
template ParserOption* OptionParser::add_option(const std::string&,
                                                std::size_t&,
                                                const std::string&);
template ParserOption* OptionParser::add_option(const std::string&,
                                                std::optional<double>&,
                                                const std::string&);
template ParserOption* OptionParser::add_option(const std::string&,
                                                std::optional<std::size_t>&,
                                                const std::string&);
template ParserOption* OptionParser::add_option(const std::string&,
                                                std::vector<std::string>&,
                                                const std::string&);

ParserOption* OptionParser::add_flag(const std::string& names,
                                     bool& value,
                                     const std::string& description) {
  return impl_->keep(impl_->app().add_flag(names, value, description));
}

ParserOption* OptionParser::get_option(const std::string& name) {
  return impl_->keep(impl_->app().get_option(name));
}

void OptionParser::footer(const std::string& text) { impl_->app().footer(text); }
std::string OptionParser::get_footer() const { return impl_->app().get_footer(); }

OptionParser* OptionParser::add_subcommand(const std::string& name, const std::string& summary) {
  CLI::App* const app = impl_->app().add_subcommand(name, summary);
  return impl_->keep(std::unique_ptr<OptionParser>(new OptionParser(std::make_unique<Impl>(*app))));
}
void OptionParser::require_subcommand(int count) { impl_->app().require_subcommand(count); }
void OptionParser::callback(std::function<void()> call) { impl_->app().callback(std::move(call)); }
bool OptionParser::parsed() const { return impl_->app().parsed(); }

std::optional<int> OptionParser::parse(int argc, const char* const* argv) {
  try {
    impl_->app().parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return impl_->app().exit(error) == 0 ? 0 : kExitUsage;
  }
  return std::nullopt;
}

Command OptionParser::describe() const { return describe_app(impl_->app()); }

}  // namespace rayloc::cli
