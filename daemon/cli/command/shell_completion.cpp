#include "daemon/cli/command/shell_completion.h"

#include <functional>

namespace rayloc::cli {
namespace {

// The text in single quotes.
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) {
    result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  }
  return result + "'";
}

std::string joined(const std::vector<std::string>& words) {
  std::string line;
  for (const std::string& word : words) {
    line += (line.empty() ? "" : " ") + word;
  }
  return line;
}

std::string after(const std::string& path, const std::string& word) { return path + " " + word; }

std::vector<std::string> names_of(const std::vector<Command>& commands) {
  std::vector<std::string> names;
  names.reserve(commands.size());
  for (const Command& command : commands) {
    names.push_back(command.name);
  }
  return names;
}

// Calls `visit` for `command` and every command below it; `path`
// is "" for rayloc and "scene show" for a verb of a verb.
void walk(const Command& command,
          const std::string& path,
          const std::function<void(const Command&, const std::string& path)>& visit) {
  visit(command, path);
  for (const Command& sub : command.commands) {
    walk(sub, path.empty() ? sub.name : path + " " + sub.name, visit);
  }
}

constexpr const char* kBashHead =
    R"(# bash completion of rayloc, written by `rayloc completion bash`.
_rayloc() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]}
  local verb='' options='' words='' i
  COMPREPLY=()
  # bash takes --name=value for three words.
  if [ "$word" = = ]; then
    word=''
  elif [ "$before" = = ] && ((COMP_CWORD > 1)); then
    before=${COMP_WORDS[COMP_CWORD - 2]}
  fi
  for ((i = 1; i < COMP_CWORD; ++i)); do
    case "$verb ${COMP_WORDS[i]}" in
)";

// If no completion of ours fits, `complete -o default` completes file names.
constexpr const char* kBashTail = R"(  esac
  case $word in
    -*) words=$options ;;
  esac
  COMPREPLY=($(compgen -W "$words" -- "$word"))
}
complete -o default -F _rayloc rayloc
)";

// Descriptions in zsh's option specifications: one line, with its special characters escaped.
std::string zsh_text(const std::string& text) {
  std::string line;
  for (const char c : text.substr(0, text.find('\n'))) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') {
      line += '\\';
    }
    line += c;
  }
  return line;
}

std::string zsh_action(const CommandOption& option) {
  return option.choices.empty() ? "_files" : "(" + joined(option.choices) + ")";
}

std::string zsh_function(const std::string& path) {
  std::string name = "_rayloc";
  if (!path.empty()) {
    name += "_" + path;
  }
  for (char& c : name) {
    c = c == ' ' || c == '-' ? '_' : c;
  }
  return name;
}

// The arguments of _arguments, one per line.
std::string zsh_specifications(const Command& command) {
  std::string lines;
  const auto add = [&](const std::string& specification) {
    lines += " \\\n    " + quoted(specification);
  };
  for (const CommandOption& option : command.options) {
    for (const std::string& name : option.names) {
      add((option.repeated ? "*" : "") + name + "[" + zsh_text(option.description) + "]" +
          (option.value.empty() ? "" : ":" + zsh_text(option.value) + ":" + zsh_action(option)));
    }
  }
  for (const CommandOption& argument : command.arguments) {
    add((argument.repeated ? "*:" : ":") + zsh_text(argument.value) + ":" + zsh_action(argument));
  }
  if (!command.commands.empty()) {
    add("1:verb:->verb");
    add("*::argument:->argument");
  }
  return lines;
}

std::string zsh_commands(const Command& command, const std::string& path) {
  std::string text = "  local -a verbs=(\n";
  for (const Command& sub : command.commands) {
    text += "    " + quoted(sub.name + ":" + zsh_text(sub.summary)) + "\n";
  }
  text +=
      "  )\n  case $state in\n    verb) _describe -t verbs verb verbs ;;\n    argument)\n"
      "      case $words[1] in\n";
  for (const Command& sub : command.commands) {
    text += "        " + sub.name + ") " +
            zsh_function(path.empty() ? sub.name : path + " " + sub.name) + " ;;\n";
  }
  return text + "      esac ;;\n  esac\n";
}

}  // namespace

std::string bash_completion(const Command& rayloc) {
  std::string verbs;
  std::string values;
  std::string options;
  walk(rayloc, "", [&](const Command& command, const std::string& path) {
    for (const Command& sub : command.commands) {
      verbs += "      " + quoted(path + " " + sub.name) +
               ") verb=" + quoted(path.empty() ? sub.name : path + " " + sub.name) + " ;;\n";
    }
    std::vector<std::string> names;
    for (const CommandOption& option : command.options) {
      names.insert(names.end(), option.names.begin(), option.names.end());
      std::string patterns;
      for (const std::string& name : option.names) {
        patterns += patterns.empty() ? "" : " | ";
        patterns += quoted(after(path, name));
      }
      if (!option.value.empty()) {
        values += "    " + patterns + ")\n      COMPREPLY=($(compgen -W " +
                  quoted(joined(option.choices)) + " -- \"$word\")); return ;;\n";
      }
    }
    std::vector<std::string> words = names_of(command.commands);
    for (const CommandOption& argument : command.arguments) {
      words.insert(words.end(), argument.choices.begin(), argument.choices.end());
    }
    options += "    " + quoted(path) + ") options=" + quoted(joined(names)) +
               " words=" + quoted(joined(words)) + " ;;\n";
  });
  return std::string(kBashHead) + verbs + "    esac\n  done\n  case \"$verb $before\" in\n" +
         values + "  esac\n  case $verb in\n" + options + kBashTail;
}

std::string zsh_completion(const Command& rayloc) {
  std::string text =
      "#compdef rayloc\n# zsh completion of rayloc, written by `rayloc completion zsh`.\n";
  walk(rayloc, "", [&](const Command& command, const std::string& path) {
    text += "\n" + zsh_function(path) +
            "() {\n  local curcontext=$curcontext state line\n"
            "  typeset -A opt_args\n  _arguments -C" +
            zsh_specifications(command) + "\n";
    if (!command.commands.empty()) {
      text += zsh_commands(command, path);
    }
    text += "}\n";
  });
  // Autoloaded, the file is the function's body; sourced, it registers itself.
  return text +
         "\nif [ \"$funcstack[1]\" = _rayloc ]; then\n  _rayloc \"$@\"\nelse\n"
         "  compdef _rayloc rayloc\nfi\n";
}

}  // namespace rayloc::cli
