// The messages of v1 are a promise: what was recorded decodes for ever, and fields are only added.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <google/protobuf/descriptor.h>
#include <google/protobuf/descriptor.pb.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "daemon/messages/json.h"
#include "rayloc/v1/carried.pb.h"
#include "rayloc/v1/cluster.pb.h"
#include "rayloc/v1/envelope.pb.h"
#include "rayloc/v1/snapshot.pb.h"
#include "tests/support/test_paths.h"

namespace rayloc::stability_test {
namespace {

namespace pb = google::protobuf;

const std::filesystem::path kRecorded = test::data_path("/proto");

std::string contents(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  EXPECT_TRUE(stream.is_open()) << file;
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

pb::FileDescriptorSet released() {
  pb::FileDescriptorSet set;
  EXPECT_TRUE(set.ParseFromString(contents(kRecorded / "rayloc_v1.binpb")));
  return set;
}

// The definitions of the messages that this build publishes.
pb::FileDescriptorSet current() {
  pb::FileDescriptorSet set;
  // These files depend on all others: the reply contains envelopes, and those contain all bodies.
  // Batches of a cluster and the carried state of a pipeline are no bodies.
  std::vector<const pb::FileDescriptor*> files{v1::SnapshotReply::descriptor()->file(),
                                               v1::Carried::descriptor()->file(),
                                               v1::CsiBatch::descriptor()->file()};
  for (std::size_t i = 0; i < files.size(); ++i) {
    files[i]->CopyTo(set.add_file());
    for (int j = 0; j < files[i]->dependency_count(); ++j) {
      if (std::find(files.begin(), files.end(), files[i]->dependency(j)) == files.end()) {
        files.push_back(files[i]->dependency(j));
      }
    }
  }
  return set;
}

template <typename Items>
void compare_named(const Items& before, const Items& after, std::vector<std::string>& broken);

void compare(const pb::DescriptorProto& before,
             const pb::DescriptorProto& after,
             std::vector<std::string>& broken) {
  for (const pb::FieldDescriptorProto& field : before.field()) {
    const std::string what = before.name() + " field " + std::to_string(field.number());
    const auto same = std::find_if(after.field().begin(), after.field().end(), [&](const auto& f) {
      return f.number() == field.number();
    });
    if (same == after.field().end()) {
      broken.push_back(what + " is gone");
      continue;
    }
    // All of it: name, type, label, message type, presence.
    pb::FieldDescriptorProto now = *same;
    pb::FieldDescriptorProto then = field;
    now.clear_json_name();  // follows from the name; CopyTo() leaves it out
    then.clear_json_name();
    now.clear_oneof_index();  // an index into a list that may grow; its name is compared instead
    then.clear_oneof_index();
    const auto oneof = [](const pb::DescriptorProto& message, const pb::FieldDescriptorProto& f) {
      return f.has_oneof_index() ? message.oneof_decl(f.oneof_index()).name() : "";
    };
    if (now.SerializeAsString() != then.SerializeAsString() ||
        oneof(after, *same) != oneof(before, field)) {
      broken.push_back(what + " changed");
    }
  }
  compare_named(before.nested_type(), after.nested_type(), broken);  // the entries of maps
}

void compare(const pb::EnumDescriptorProto& before,
             const pb::EnumDescriptorProto& after,
             std::vector<std::string>& broken) {
  for (const pb::EnumValueDescriptorProto& value : before.value()) {
    if (std::none_of(after.value().begin(), after.value().end(), [&](const auto& v) {
          return v.number() == value.number() && v.name() == value.name();
        })) {
      broken.push_back(before.name() + " value " + std::to_string(value.number()) + " changed");
    }
  }
}

template <typename Items>
void compare_named(const Items& before, const Items& after, std::vector<std::string>& broken) {
  for (const auto& item : before) {
    const auto same = std::find_if(
        after.begin(), after.end(), [&](const auto& other) { return other.name() == item.name(); });
    if (same == after.end()) {
      broken.push_back(item.name() + " is gone");
    } else {
      compare(item, *same, broken);
    }
  }
}

std::vector<std::string> breaking_changes(const pb::FileDescriptorSet& before,
                                          const pb::FileDescriptorSet& after) {
  std::vector<std::string> broken;
  for (const pb::FileDescriptorProto& file : before.file()) {
    const auto same = std::find_if(after.file().begin(), after.file().end(), [&](const auto& f) {
      return f.name() == file.name() && f.package() == file.package();
    });
    if (same == after.file().end()) {
      broken.push_back(file.name() + " is gone");
      continue;
    }
    compare_named(file.message_type(), same->message_type(), broken);
    compare_named(file.enum_type(), same->enum_type(), broken);
  }
  return broken;
}

TEST(Stability, NoFieldOfTheReleaseChanged) {
  const pb::FileDescriptorSet before = released();
  ASSERT_GT(before.file_size(), 8);
  EXPECT_EQ(breaking_changes(before, current()), std::vector<std::string>{});
}

// The descriptor set of the release is committed after each addition, so that the addition is kept.
TEST(Stability, EveryFieldIsPartOfTheCommittedRelease) {
  EXPECT_EQ(breaking_changes(current(), released()), std::vector<std::string>{})
      << "after adding to proto/, run tests/data/proto/release and commit what it made";
}

pb::DescriptorProto& message(pb::FileDescriptorSet& set, const std::string& name) {
  for (pb::FileDescriptorProto& file : *set.mutable_file()) {
    for (pb::DescriptorProto& type : *file.mutable_message_type()) {
      if (type.name() == name) {
        return type;
      }
    }
  }
  throw std::runtime_error("no message " + name);
}

TEST(Stability, TheComparisonSeesEachKindOfBreak) {
  const pb::FileDescriptorSet before = released();
  const auto after = [&](auto&& change) {
    pb::FileDescriptorSet changed = before;
    change(message(changed, "Location"));
    return breaking_changes(before, changed);
  };
  EXPECT_EQ(after([](auto&) {}), std::vector<std::string>{});
  EXPECT_EQ(after([](auto& m) { m.mutable_field(0)->set_number(99); }),
            std::vector<std::string>{"Location field 1 is gone"});
  EXPECT_EQ(after([](auto& m) { m.mutable_field(0)->set_name("id"); }),
            std::vector<std::string>{"Location field 1 changed"});
  EXPECT_EQ(
      after([](auto& m) { m.mutable_field(0)->set_type(pb::FieldDescriptorProto::TYPE_BYTES); }),
      std::vector<std::string>{"Location field 1 changed"});
  EXPECT_EQ(after([](auto& m) { m.mutable_field(2)->set_type_name(".rayloc.v1.Point"); }),
            std::vector<std::string>{"Location field 3 changed"});
  EXPECT_EQ(after([](auto& m) {
              m.mutable_field(0)->set_label(pb::FieldDescriptorProto::LABEL_REPEATED);
            }),
            std::vector<std::string>{"Location field 1 changed"});
  EXPECT_EQ(after([](auto& m) { m.add_field()->set_number(100); }), std::vector<std::string>{});
}

TEST(Stability, RecordedBytesDecodeAndPrintAsBefore) {
  std::vector<bool> seen(20);
  for (const auto& entry : std::filesystem::directory_iterator(kRecorded / "envelopes")) {
    if (entry.path().extension() != ".binpb") {
      continue;
    }
    const std::string bytes = contents(entry.path());
    v1::Envelope envelope;
    ASSERT_TRUE(envelope.ParseFromString(bytes)) << entry.path();
    seen[static_cast<std::size_t>(envelope.body_case())] = true;
    // Nothing was unknown to this build, and it writes the same bytes.
    EXPECT_EQ(envelope.SerializeAsString(), bytes) << entry.path();

    std::filesystem::path recorded_json = entry.path();
    recorded_json.replace_extension(".json");
    const auto json = to_json(envelope);
    ASSERT_TRUE(json) << json.error().message;
    EXPECT_EQ(nlohmann::json::parse(*json), nlohmann::json::parse(contents(recorded_json)));

    v1::Envelope read_back;
    ASSERT_TRUE(from_json(*json, read_back)) << entry.path();
    EXPECT_EQ(read_back.SerializeAsString(), bytes) << entry.path();
  }
  for (const int body : {v1::Envelope::kLocation,
                         v1::Envelope::kTrack,
                         v1::Envelope::kZone,
                         v1::Envelope::kSource,
                         v1::Envelope::kHeartbeat,
                         v1::Envelope::kCsi,
                         v1::Envelope::kGoodbye,
                         v1::Envelope::kCompared}) {
    EXPECT_TRUE(seen[static_cast<std::size_t>(body)]) << "no recorded envelope with body " << body;
  }
}

}  // namespace
}  // namespace rayloc::stability_test
