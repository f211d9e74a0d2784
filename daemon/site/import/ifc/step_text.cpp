#include "daemon/site/import/ifc/step_text.h"

#include <algorithm>
#include <charconv>
#include <numeric>
#include <utility>

#include <spdlog/fmt/fmt.h>

namespace rayloc {
namespace {

constexpr std::size_t kMaxNesting = 32;    // of lists, chosen: IFC 2x3 needs 3
constexpr std::ptrdiff_t kMaxDigits = 18;  // of an id, for 64 bits

bool is_step_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }
bool is_step_digit(char c) { return c >= '0' && c <= '9'; }
char capital(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; }
bool is_printed(char c) { return c > 0x20 && c < 0x7f; }

// Copies statements without their comments, spaces and ends.
class StatementReader {
 public:
  StatementReader(std::string_view bytes, const std::string& file, std::string& out)
      : bytes_(bytes), file_(file), out_(out) {}

  // Appends the next statement without its ';'. False: the file has no more.
  Expected<bool> next() {
    const std::size_t begin = out_.size();
    std::size_t depth = 0;
    while (at_ < bytes_.size()) {
      const char c = bytes_[at_];
      if (bytes_.substr(at_, 2) == "/*") {
        RAYLOC_TRY(skip_comment());
        continue;
      }
      if (is_step_space(c)) {
        line_ += c == '\n' ? 1 : 0;
        ++at_;
        continue;
      }
      if (out_.size() == begin) {
        first_line_ = line_;
      }
      if (c == '\'') {
        RAYLOC_TRY(copy_string());
        continue;
      }
      ++at_;
      if (c == ';') {
        return true;
      }
      if (c == '/') {  // with the next character, it may begin a comment in the text for assimp
        return refuse("has a '/' outside strings and comments; export it again");
      }
      if (!is_printed(c)) {
        return refuse("has a byte outside a string that no STEP file has; export it again");
      }
      if (c == '(') {
        ++depth;
      } else if (c == ')' && depth > 0) {
        --depth;
      }
      if (depth > kMaxNesting) {
        return refuse(
            fmt::format("has lists nested more than {} deep, which no IFC 2x3 file has; "
                        "export it again",
                        kMaxNesting));
      }
      out_ += c;
    }
    if (out_.size() == begin) {
      return false;
    }
    return refuse("the file ends within a statement; copy or export it again");
  }
  std::uint32_t line() const { return first_line_; }
  tl::unexpected<Error> refuse(const std::string& what) const {
    return bad_input(fmt::format("{}:{}: {}", file_, line_, what));
  }

 private:
  Expected<void> skip_comment() {
    const std::size_t end = bytes_.find("*/", at_ + 2);
    if (end == std::string_view::npos) {
      return refuse("a comment has no end; export the file again");
    }
    const std::string_view comment = bytes_.substr(at_, end - at_);
    line_ += static_cast<std::uint32_t>(std::count(comment.begin(), comment.end(), '\n'));
    at_ = end + 2;
    return {};
  }
  // Two quotes are a quote within the string; an end of line within one does not count.
  Expected<void> copy_string() {
    const std::uint32_t line = line_;
    out_ += bytes_[at_++];
    while (at_ < bytes_.size()) {
      const char c = bytes_[at_++];
      if (c == '\n' || c == '\r') {
        line_ += c == '\n' ? 1 : 0;
        continue;
      }
      out_ += c;
      if (c == '\'') {
        if (at_ == bytes_.size() || bytes_[at_] != '\'') {
          return {};
        }
        out_ += bytes_[at_++];
      }
    }
    line_ = line;
    return refuse("a string has no end; copy or export the file again");
  }

  std::string_view bytes_;
  const std::string& file_;
  std::string& out_;
  std::size_t at_ = 0;
  std::uint32_t line_ = 1;
  std::uint32_t first_line_ = 1;
};

// True if the first parenthesis is closed by the last character.
bool is_one_list(std::string_view text) {
  std::size_t depth = 0;
  for (std::size_t at = 0; at < text.size();) {
    if (text[at] == '\'') {
      at = step_string_end(text, at);
      continue;
    }
    if (text[at] == '(') {
      ++depth;
    } else if (text[at] == ')' && (depth == 0 || --depth == 0)) {
      return at + 1 == text.size();
    }
    ++at;
  }
  return false;
}

}  // namespace

std::string clipped_step(std::string_view text) {
  constexpr std::size_t kMaxText = 40;
  if (text.size() <= kMaxText) {
    return std::string(text);
  }
  std::size_t size = kMaxText;
  while (size > 0 && (static_cast<unsigned char>(text[size]) & 0xc0U) == 0x80U) {
    --size;  // no character of UTF-8 is cut
  }
  return std::string(text.substr(0, size)) + "...";
}

std::size_t step_string_end(std::string_view text, std::size_t at) {
  for (++at; at < text.size(); ++at) {
    if (text[at] == '\'') {
      if (at + 1 == text.size() || text[at + 1] != '\'') {
        return at + 1;
      }
      ++at;
    }
  }
  return at;
}

Expected<StepText> StepText::parse(std::string_view bytes, const std::string& file) {
  StepText step;
  step.text_.reserve(bytes.size());
  StatementReader reader(bytes, file, step.text_);
  enum class Section { kNone, kHeader, kData } section = Section::kNone;
  bool has_ended = false;
  for (;;) {
    const std::size_t begin = step.text_.size();
    const auto more = reader.next();
    RAYLOC_TRY(more);
    if (!*more) {
      break;
    }
    const std::string statement =
        step.text_.substr(begin, section == Section::kData ? std::size_t{8} : std::string::npos);
    if (statement == "ENDSEC") {
      has_ended = has_ended || section == Section::kData;
      section = Section::kNone;
    } else if (section == Section::kData) {
      RAYLOC_TRY(step.add(begin, reader.line(), fmt::format("{}:{}: ", file, reader.line())));
      continue;  // its text is kept
    } else if (statement == "DATA" || statement.starts_with("DATA(")) {
      section = Section::kData;
    } else if (statement == "HEADER") {
      section = Section::kHeader;
    } else if (section == Section::kHeader && statement.starts_with("FILE_SCHEMA(")) {
      const std::size_t quote = std::min(statement.find('\''), statement.size());
      const std::size_t end = quote < statement.size() ? step_string_end(statement, quote) : quote;
      step.schema_ = step_string(std::string_view(statement).substr(quote, end - quote));
      std::transform(step.schema_.begin(), step.schema_.end(), step.schema_.begin(), capital);
    }
    step.text_.resize(begin);
  }
  if (!has_ended) {
    return reader.refuse("the file ends before its data do (ENDSEC); copy or export it again");
  }
  step.sort();
  RAYLOC_TRY(step.check_ids(file));
  return step;
}

Expected<void> StepText::add(std::size_t begin, std::uint32_t line, const std::string& place) {
  const std::string_view all = std::string_view(text_).substr(begin);
  const std::size_t equals = all.find('=');
  const std::size_t list = all.find('(');
  StepEntity entity;
  entity.line = line;
  const bool has_head = equals != std::string_view::npos && list != std::string_view::npos &&
                        equals < list && all.front() == '#';
  if (has_head) {
    entity.id = step_reference(all.substr(0, equals));
  }
  if (entity.id == 0 || !is_one_list(all.substr(list))) {
    return bad_input(place +
                     "is no entity of a STEP file (#1=IFCWALL(...);); export the file again");
  }
  for (std::size_t at = equals + 1; at < list; ++at) {
    text_[begin + at] = capital(text_[begin + at]);
  }
  entity.type_at = static_cast<std::uint32_t>(begin + equals + 1);
  entity.type_size = static_cast<std::uint32_t>(list - equals - 1);
  entity.arguments_at = static_cast<std::uint32_t>(begin + list);
  entity.arguments_size = static_cast<std::uint32_t>(all.size() - list);
  entities_.push_back(entity);
  return {};
}

void StepText::sort() {
  by_id_.resize(entities_.size());
  std::iota(by_id_.begin(), by_id_.end(), 0U);
  std::stable_sort(by_id_.begin(), by_id_.end(), [&](std::uint32_t a, std::uint32_t b) {
    return entities_[a].id < entities_[b].id;
  });
}

Expected<void> StepText::check_ids(const std::string& file) const {
  const auto twice =
      std::adjacent_find(by_id_.begin(), by_id_.end(), [&](std::uint32_t a, std::uint32_t b) {
        return entities_[a].id == entities_[b].id;
      });
  if (twice != by_id_.end()) {
    const StepEntity& second = entities_[*std::next(twice)];
    return bad_input(fmt::format("{}:{}: #{} is defined twice, first in line {}; export it again",
                                 file,
                                 second.line,
                                 second.id,
                                 entities_[*twice].line));
  }
  return {};
}

void StepWriter::add(std::uint64_t id,
                     std::uint32_t line,
                     std::string_view type,
                     std::string_view arguments) {
  StepEntity entity;
  entity.id = id;
  entity.line = line;
  entity.type_at = static_cast<std::uint32_t>(step_.text_.size());
  entity.type_size = static_cast<std::uint32_t>(type.size());
  step_.text_ += type;
  entity.arguments_at = static_cast<std::uint32_t>(step_.text_.size());
  entity.arguments_size = static_cast<std::uint32_t>(arguments.size());
  step_.text_ += arguments;
  step_.entities_.push_back(entity);
}

StepText StepWriter::finish() {
  step_.sort();
  return std::move(step_);
}

std::optional<std::size_t> StepText::find(std::uint64_t id) const {
  const auto found =
      std::lower_bound(by_id_.begin(), by_id_.end(), id, [&](std::uint32_t a, std::uint64_t b) {
        return entities_[a].id < b;
      });
  if (found == by_id_.end() || entities_[*found].id != id) {
    return std::nullopt;
  }
  return *found;
}

std::vector<std::string_view> step_items(std::string_view list) {
  std::vector<std::string_view> items;
  if (list.size() < 2 || list.front() != '(' || list.back() != ')' || list == "()") {
    return items;
  }
  std::size_t begin = 1;
  std::size_t depth = 0;
  for (std::size_t at = 1; at + 1 < list.size();) {
    if (list[at] == '\'') {
      at = step_string_end(list, at);
      continue;
    }
    if (list[at] == '(') {
      ++depth;
    } else if (list[at] == ')' && depth > 0) {
      --depth;
    }
    if (list[at] == ',' && depth == 0) {
      items.push_back(list.substr(begin, at - begin));
      begin = at + 1;
    }
    ++at;
  }
  items.push_back(list.substr(begin, list.size() - 1 - begin));
  return items;
}

std::uint64_t step_reference(std::string_view value) {
  std::uint64_t id = 0;
  if (value.size() < 2 || value.front() != '#') {
    return 0;
  }
  const char* const end = value.data() + value.size();
  const auto read = std::from_chars(value.data() + 1, end, id);
  return read.ec == std::errc() && read.ptr == end && read.ptr - value.data() - 1 <= kMaxDigits ? id
                                                                                                : 0;
}

void each_step_reference(std::string_view arguments,
                         const std::function<void(std::uint64_t)>& found) {
  for (std::size_t at = 0; at < arguments.size();) {
    if (arguments[at] == '\'') {
      at = step_string_end(arguments, at);
      continue;
    }
    if (arguments[at] != '#') {
      ++at;
      continue;
    }
    std::size_t end = at + 1;
    while (end < arguments.size() && is_step_digit(arguments[end])) {
      ++end;
    }
    found(step_reference(arguments.substr(at, end - at)));
    at = end;
  }
}

}  // namespace rayloc
