#include "daemon/cli/command/manual_page.h"

#include <sstream>

#include "daemon/base/roff.h"

namespace rayloc::cli {
namespace {

constexpr const char* kHead = R"(.\" Written by `rayloc man`; do not edit.
.TH RAYLOC 1 "" "rayloc )" RAYLOC_VERSION R"(" "User commands"
.SH NAME
rayloc \- Wi\-Fi localization from channel state information
.SH SYNOPSIS
.B rayloc
.I VERB
.RI [ option " ...] [" argument " ...]"
.SH DESCRIPTION
Tools beside the daemon
.BR raylocd (8):
they record, calibrate, replay, evaluate and monitor it.
Data goes to standard output, messages to standard error.
A
.I SITE
is a folder with
.IR site.toml .
.I [AP=]FILE
is a recording (pcap or pcapng, gzip'd or not) and the access point that made it, which may be left
out where the site has one.
)";

constexpr const char* kTail = R"(.SH EXIT STATUS
.TP
.B 0
done
.TP
.B 64
the command line is wrong
.TP
.B 65
the data is wrong
.TP
.B 69
a device, port or daemon is not available
.TP
.B 70
a fault of rayloc itself
.TP
.B 78
the configuration is wrong
.TP
.B 79
a calibration is no success: it explains its survey no better than the plan does, or the survey
contradicts the site
.SH SEE ALSO
.BR raylocd (8),
.BR raylocd.toml (5)
)";

// Text of several lines, with line breaks kept.
std::string lines(const std::string& text) {
  std::string result;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    result += (result.empty() ? "" : ".br\n") + roff(line) + "\n";
  }
  return result;
}

// Unchanged text in a typewriter face.
std::string verbatim(const std::string& text) {
  std::string result;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    // mandoc(1) warns of blank lines; a line without text renders the same.
    result += (line.empty() ? "\\&" : roff(line)) + "\n";
  }
  return result.empty() ? "" : ".PP\n.nf\n" + result + ".fi\n";
}

std::string value_of(const CommandOption& option) {
  if (option.choices.empty()) {
    return option.value;
  }
  std::string text;
  for (const std::string& choice : option.choices) {
    text += (text.empty() ? "" : "|") + choice;
  }
  return text;
}

// A list entry: the option or argument in bold and italics, then its description.
std::string entry(const CommandOption& option) {
  std::string names;
  for (const std::string& name : option.names) {
    names += (names.empty() ? "" : ", ") + name;
  }
  std::string text = ".TP\n";
  if (names.empty()) {
    text += ".I " + roff(option.value) + "\n";
  } else if (option.value.empty()) {
    text += ".B " + roff(names) + "\n";
  } else {
    text += "\\fB" + roff(names) + "\\fR \\fI" + roff(value_of(option)) + "\\fR\n";
  }
  text += option.description.empty() ? "\\&\n" : lines(option.description);
  if (!option.preset.empty()) {
    text += ".br\nDefault: " + roff(option.preset) + "\n";
  }
  return text;
}

std::string usage(const Command& command, const std::string& path) {
  std::string text = "\\fBrayloc " + roff(path) + "\\fR";
  if (!command.commands.empty()) {
    text += " \\fIVERB\\fR";
  }
  for (const CommandOption& argument : command.arguments) {
    const std::string name =
        "\\fI" + roff(argument.value) + "\\fR" + (argument.repeated ? " ..." : "");
    text += argument.required ? " " + name : " [" + name + "]";
  }
  for (const CommandOption& option : command.options) {
    if (option.required) {
      text += " \\fB" + roff(option.names.front()) + "\\fR \\fI" + roff(value_of(option)) + "\\fR" +
              (option.repeated ? " ..." : "");
    }
  }
  return text + " [\\fIoption\\fR ...]\n";
}

// The section of a verb, followed by the sections of its own verbs.
std::string section(const Command& command, const std::string& path) {
  std::string text =
      ".SS rayloc " + roff(path) + "\n" + lines(command.summary) + ".PP\n" + usage(command, path);
  for (const CommandOption& argument : command.arguments) {
    text += entry(argument);
  }
  for (const CommandOption& option : command.options) {
    if (option.names.front() != "--help") {
      text += entry(option);
    }
  }
  text += verbatim(command.notes);
  for (const Command& sub : command.commands) {
    text += section(sub, path + " " + sub.name);
  }
  return text;
}

}  // namespace

std::string manual_page(const Command& rayloc) {
  std::string page = kHead;
  page += ".SH OPTIONS\n";
  for (const CommandOption& option : rayloc.options) {
    page += entry(option);
  }
  page += ".P\nEach verb has\n.BR \\-\\-help ,\ntoo.\n.SH VERBS\n";
  for (const Command& verb : rayloc.commands) {
    page += section(verb, verb.name);
  }
  return page + kTail;
}

}  // namespace rayloc::cli
