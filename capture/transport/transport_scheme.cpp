#include "capture/transport/transport_scheme.h"

#include <algorithm>
#include <cctype>

#include "engine/base/check.h"
#include "engine/base/suggestion.h"

namespace rayloc {
namespace {

const TransportScheme* find_scheme(TransportTable table, std::string_view name) {
  const auto found =
      std::find_if(table.begin(), table.end(), [&](const auto& row) { return row.name == name; });
  return found == table.end() ? nullptr : &*found;
}

// The text before the first colon if it can be a scheme: a letter, then letters, digits, '+' and
// '-', but no dot, which files and hosts have; otherwise empty.
std::string_view scheme_of(std::string_view text) {
  const std::string_view word = text.substr(0, std::min(text.find(':'), text.size()));
  const bool named = word.size() < text.size() && !word.empty() &&
                     std::isalpha(static_cast<unsigned char>(word.front())) != 0 &&
                     std::all_of(word.begin(), word.end(), [](unsigned char c) {
                       return std::isalnum(c) != 0 || c == '+' || c == '-';
                     });
  return named ? word : std::string_view();
}

std::string names_text(TransportTable table, std::string_view word) {
  std::vector<std::string_view> names;
  for (const TransportScheme& row : table) {
    names.push_back(row.name);
  }
  return suggestion(word, names);
}

// A port that cannot be bound is not an error of notation.
template <typename T>
Expected<T> explained(Expected<T> opened, TransportTable table, const std::string& text) {
  const std::string_view word = scheme_of(text);
  if (!opened && opened.error().kind == ErrorKind::kUsage && !word.empty() &&
      find_scheme(table, word) == nullptr) {
    opened.error().message +=
        "; '" + std::string(word) + "' is no transport either" + names_text(table, word);
  }
  return opened;
}

bool serves(const TransportScheme& row, TransportUse use) {
  return use == TransportUse::kSink
             ? row.open_sink != nullptr
             : row.open_source != nullptr && (row.live || use != TransportUse::kLiveSource);
}

}  // namespace

Expected<TransportAddress> parse_transport(TransportTable table,
                                           const std::string& text,
                                           std::string_view plain) {
  const std::string_view word = scheme_of(text);
  if (const TransportScheme* scheme = find_scheme(table, word)) {
    return TransportAddress{scheme, text.substr(word.size() + 1)};
  }
  if (!plain.empty()) {
    const TransportScheme* scheme = find_scheme(table, plain);
    RAYLOC_CHECK(scheme != nullptr);
    return TransportAddress{scheme, text};
  }
  return make_error(ErrorKind::kUsage,
                    "'" + text + "': " +
                        (word.empty() ? "no transport is named"
                                      : "there is no transport '" + std::string(word) + "'" +
                                            names_text(table, word)) +
                        "; write SCHEME:ADDRESS, for example " +
                        std::string(table.empty() ? "" : table.front().example));
}

Expected<std::unique_ptr<DatagramSource>> open_datagram_source(TransportTable table,
                                                               const std::string& text,
                                                               std::string_view plain,
                                                               const SourceOptions& options) {
  const auto where = parse_transport(table, text, plain);
  RAYLOC_TRY(where);
  if (where->scheme->open_source == nullptr) {
    return make_error(ErrorKind::kUsage,
                      "'" + text + "': nothing can be received this way; there are: " +
                          transport_syntax(table, TransportUse::kSource));
  }
  return explained(where->scheme->open_source(where->address, options), table, text);
}

Expected<std::unique_ptr<DatagramSink>> open_datagram_sink(TransportTable table,
                                                           const std::string& text,
                                                           std::string_view plain) {
  const auto where = parse_transport(table, text, plain);
  RAYLOC_TRY(where);
  if (where->scheme->open_sink == nullptr) {
    return make_error(ErrorKind::kUsage,
                      "'" + text + "': nothing can be sent this way; there are: " +
                          transport_syntax(table, TransportUse::kSink));
  }
  return explained(where->scheme->open_sink(where->address), table, text);
}

std::string transport_syntax(TransportTable table, TransportUse use) {
  std::vector<std::string> forms;
  for (const TransportScheme& row : table) {
    if (serves(row, use)) {
      forms.push_back(std::string(row.name) + ":" + std::string(row.address));
    }
  }
  std::string text;
  for (std::size_t i = 0; i < forms.size(); ++i) {
    text += (i == 0 ? "" : i + 1 == forms.size() ? " or " : ", ") + forms[i];
  }
  return text;
}

}  // namespace rayloc
