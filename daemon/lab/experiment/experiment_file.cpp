#include "daemon/lab/experiment/experiment_file.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <utility>

#include "daemon/methods/method_registry.h"
#include "daemon/site/model/toml_reader.h"
#include "engine/base/suggestion.h"
#include "engine/paper/settings.h"

namespace rayloc {
namespace {

// One value of a key, as a function that sets it in a condition.
using Value = std::function<void(Condition&)>;

struct Stated {
  std::string key;
  bool is_axis = false;
  std::vector<Value> values;
};

// Checks that the numbers are whole.
bool check_whole(const TomlTable& table, std::string_view key, const std::vector<double>& values) {
  const bool whole =
      std::all_of(values.begin(), values.end(), [](double x) { return x == std::trunc(x); });
  if (!whole) {
    table.error_at(key, "'" + std::string(key) + "' counts something; write whole numbers");
  }
  return whole;
}

std::vector<Value> read_values(const TomlTable& table, const ConditionKey& key) {
  std::vector<Value> values;
  if (const auto* number = std::get_if<double Condition::*>(&key.member)) {
    const std::vector<double> numbers = table.numbers(key.key, key.range);
    if (key.is_whole && !check_whole(table, key.key, numbers)) {
      return {};
    }
    for (const double x : numbers) {
      values.emplace_back([member = *number, x](Condition& c) { c.*member = x; });
    }
    return values;
  }
  for (const std::string& text : table.strings(key.key)) {
    if (!key.names.empty() &&
        std::find(key.names.begin(), key.names.end(), text) == key.names.end()) {
      table.error_at(key.key,
                     "'" + text + "' is no value of '" + std::string(key.key) + "'" +
                         suggestion(text, key.names));
      continue;
    }
    if (const auto* name = std::get_if<std::string Condition::*>(&key.member)) {
      values.emplace_back([member = *name, text](Condition& c) { c.*member = text; });
    } else {
      const auto member = std::get<std::filesystem::path Condition::*>(key.member);
      values.emplace_back(
          [member, path = table.file().parent_path() / text](Condition& c) { c.*member = path; });
    }
  }
  return values;
}

std::vector<Value> read_values(const TomlTable& table, const paper::Setting& setting) {
  std::vector<Value> values;
  std::vector<double> numbers;
  if (setting.kind == paper::SettingKind::kFlag) {
    for (const bool flag : table.booleans(setting.key)) {
      numbers.push_back(flag ? 1.0 : 0.0);
    }
  } else {
    numbers = table.numbers(setting.key, {setting.min, setting.max, {}});
    if (setting.kind == paper::SettingKind::kWhole && !check_whole(table, setting.key, numbers)) {
      return {};
    }
  }
  values.reserve(numbers.size());
  for (const double x : numbers) {
    values.emplace_back(
        [key = std::string(setting.key), x](Condition& c) { c.paper.insert_or_assign(key, x); });
  }
  return values;
}

// All keys stated in a table, in order of the tables of keys.
std::vector<Stated> read_stated(const TomlTable& table) {
  std::vector<Stated> stated;
  for (const ConditionKey& key : condition_keys()) {
    auto values = read_values(table, key);
    if (!values.empty()) {
      stated.push_back({std::string(key.key), table.is_array(key.key), std::move(values)});
    }
  }
  if (const auto paper = table.table("paper")) {
    for (const paper::Setting& setting : paper::settings()) {
      auto values = read_values(*paper, setting);
      if (!values.empty()) {
        stated.push_back(
            {"paper." + std::string(setting.key), paper->is_array(setting.key), std::move(values)});
      }
    }
  }
  return stated;
}

// All combinations; the last key varies fastest.
std::vector<Condition> combine(const Condition& base, const std::vector<Stated>& stated) {
  std::vector<Condition> conditions = {base};
  for (const Stated& one : stated) {
    std::vector<Condition> more;
    for (const Condition& condition : conditions) {
      for (const Value& value : one.values) {
        more.push_back(condition);
        value(more.back());
      }
    }
    conditions = std::move(more);
  }
  return conditions;
}

class ExperimentReader {
 public:
  explicit ExperimentReader(const TomlTable& root) : root_(root) {}

  Experiment read() {
    root_.require({{"name", "name = \"Clutter\""}});
    Experiment experiment;
    experiment.name = root_.string("name").value_or("");
    experiment.seed = static_cast<std::uint64_t>(
        root_.integer("seed", {0, 9e15, {}}).value_or(static_cast<std::int64_t>(1)));
    Condition base = default_condition();
    if (const auto defaults = root_.table("defaults")) {
      for (const Stated& one : read_stated(*defaults)) {
        if (one.is_axis) {
          defaults->error_at(one.key.substr(0, one.key.find('.')),
                             "'" + one.key + "' is a list; an axis belongs into a [[study]]");
        }
        one.values.front()(base);
      }
    }
    const auto studies = root_.tables("study");
    if (studies.empty()) {
      root_.error("the file has no [[study]]; add one, its keys below it");
    }
    for (const TomlTable& table : studies) {
      experiment.studies.push_back(read_study(table, base));
    }
    return experiment;
  }

 private:
  Study read_study(const TomlTable& table, const Condition& base) {
    table.require({{"name", "name = \"boxes\""}});
    Study study;
    study.name = table.string("name").value_or("");
    if (!study.name.empty() && !names_.insert(study.name).second) {
      table.error_at("name", "a second study '" + study.name + "'; give each its own name");
    }
    study.claim = table.string("claim").value_or("");
    const std::vector<Stated> stated = read_stated(table);
    std::size_t count = 1;
    for (const Stated& one : stated) {
      count *= one.values.size();
      if (count > kMaxConditions) {
        table.error("the lists of the study make more than " + std::to_string(kMaxConditions) +
                    " conditions; shorten them");
        return study;
      }
      if (one.is_axis) {
        study.axes.push_back(one.key);
      }
    }
    study.conditions = combine(base, stated);
    for (const Condition& condition : study.conditions) {
      if (!check(table, condition)) {
        return study;
      }
    }
    choose_over(table, study);
    return study;
  }

  // Checks for impossible conditions; false if an error was noted.
  static bool check(const TomlTable& table, const Condition& condition) {
    if (condition.room.empty()) {
      table.error(table.name() +
                  " states no 'room', nor does [defaults]; add, for example: room = "
                  "\"rooms/office.toml\"");
      return false;
    }
    const Method* method = find_method(condition.method);  // null: a control, for any kind
    if (method != nullptr && (condition.kind == "person" ? method->create_person == nullptr
                                                         : method->create_device == nullptr)) {
      table.error(table.name() + ": method " + condition.method + " does not locate kind '" +
                  condition.kind + "'; choose another method or kind");
      return false;
    }
    if (condition.kind == "person") {
      for (const std::string_view key :
           {"height_sigma_m", "model_height_sigma_m", "tilt_deg", "power_sigma_db"}) {
        if (condition_number(condition, key) != 0.0) {
          table.error(table.name() + ": '" + std::string(key) +
                      "' is of devices; leave it out where kind is 'person'");
          return false;
        }
      }
    }
    const paper::LocalizerOptions paper = condition.paper_options();
    for (const auto& valid : {validate(paper.descent), validate(paper.csi.smoothing)}) {
      if (!valid) {
        table.error_at("paper", valid.error().message);
        return false;
      }
    }
    return true;
  }

  static void choose_over(const TomlTable& table, Study& study) {
    const auto is_numeric = [&](const std::string& axis) {
      return condition_number(study.conditions.front(), axis).has_value();
    };
    if (const auto over = table.string("over")) {
      if (std::find(study.axes.begin(), study.axes.end(), *over) == study.axes.end() ||
          !is_numeric(*over)) {
        table.error_at("over",
                       "'" + *over + "' is no list of numbers of this study; name one of its axes");
        return;
      }
      study.over = *over;
      return;
    }
    const auto first = std::find_if(study.axes.begin(), study.axes.end(), is_numeric);
    study.over = first == study.axes.end() ? "" : *first;
  }

  const TomlTable& root_;
  std::set<std::string> names_;
};

Expected<Experiment> read_document(TomlDocument& document) {
  const TomlTable root = document.root();
  Experiment experiment = ExperimentReader(root).read();
  RAYLOC_TRY(document.finish());
  return experiment;
}

}  // namespace

Expected<Experiment> load_experiment(const std::filesystem::path& file) {
  const auto document = TomlDocument::read(file);
  return document ? read_document(**document) : tl::make_unexpected(document.error());
}

Expected<Experiment> parse_experiment(std::string_view text, const std::filesystem::path& file) {
  const auto document = TomlDocument::parse(text, file);
  return document ? read_document(**document) : tl::make_unexpected(document.error());
}

Expected<void> keep_studies(const std::vector<std::string>& names, Experiment& experiment) {
  for (const std::string& name : names) {
    if (std::none_of(experiment.studies.begin(), experiment.studies.end(), [&](const auto& study) {
          return study.name == name;
        })) {
      return make_error(ErrorKind::kUsage, "--study '" + name + "': the file has no such study");
    }
  }
  if (!names.empty()) {
    std::erase_if(experiment.studies, [&](const Study& study) {
      return std::find(names.begin(), names.end(), study.name) == names.end();
    });
  }
  return {};
}

}  // namespace rayloc
