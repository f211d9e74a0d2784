#include "daemon/live/config/secrets.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/live/config/config.h"
#include "daemon/live/publish/socket/curve_keys.h"

namespace rayloc::secrets_test {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr const char* kToken = "0123456789abcdef0123456789abcdef";

class Secrets : public ::testing::Test {
 protected:
  Secrets() {
    std::string name = (fs::temp_directory_path() / "secrets.XXXXXX").string();
    EXPECT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
    setenv("CREDENTIALS_DIRECTORY", folder_.c_str(), 1);
  }
  void TearDown() override {
    unsetenv("CREDENTIALS_DIRECTORY");
    fs::remove_all(folder_);
  }

  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    fs::permissions(folder_ / name, fs::perms::owner_read | fs::perms::owner_write);
    return folder_ / name;
  }

  static DaemonConfig parsed(const std::string& more) {
    const std::string text = "[site]\ndirectory = \"/s\"\n[[source]]\nkind = \"udp\"\n" + more;
    Expected<DaemonConfig> config = parse_config(text, "/etc/raylocd/raylocd.toml");
    EXPECT_TRUE(config) << config.error().message;
    return config ? *std::move(config) : DaemonConfig();
  }

  fs::path folder_;
};

constexpr const char* kAnyAddress = "[http]\nlisten = \"0.0.0.0:8480\"\n";

TEST_F(Secrets, ACredentialTakesThePlaceOfAFileThatIsNotStated) {
  const fs::path token = write("http.token", kToken);
  const fs::path key = write("privacy.key", kToken);
  const fs::path secret = write("curve.secret", kToken);
  const DaemonConfig config = parsed(kAnyAddress);
  EXPECT_EQ(config.http.token_file, token);
  EXPECT_EQ(config.privacy.key_file, key);
  EXPECT_EQ(config.curve.secret_file, secret);

  const DaemonConfig stated = parsed("[http]\ntoken_file = \"/other\"\n");
  EXPECT_EQ(stated.http.token_file, "/other");
}

TEST_F(Secrets, WithoutACredentialNothingIsTaken) {
  EXPECT_EQ(parsed("").http.token_file, "");
  unsetenv("CREDENTIALS_DIRECTORY");
  EXPECT_EQ(parsed("").privacy.key_file, "");
}

TEST_F(Secrets, EachThatCannotBeUsedIsNamedWithTheReason) {
  DaemonConfig config;
  config.http.token_file = folder_ / "none";
  config.privacy.target_id = TargetId::kHmac;
  config.privacy.key_file = folder_ / "neither";
  config.curve.enabled = true;
  config.curve.secret_file = write("curve", "short\n");
  const Expected<void> checked = check_secrets(config);
  ASSERT_FALSE(checked);
  EXPECT_EQ(checked.error().kind, ErrorKind::kConfiguration);
  EXPECT_THAT(
      checked.error().message,
      AllOf(HasSubstr((folder_ / "none").string() +
                      ": the token cannot be read: No such file or directory"),
            HasSubstr("\n" + (folder_ / "neither").string() +
                      ": the key cannot be read: No such file or directory"),
            HasSubstr("\n" + (folder_ / "curve").string() + ": its first line is no secret key")));

  config.http.token_file = write("token", kToken);
  config.privacy.key_file = config.http.token_file;
  config.curve.enabled = false;
  EXPECT_TRUE(check_secrets(config)) << check_secrets(config).error().message;
  // Secrets of a disabled section are not read.
  config.http.enabled = false;
  config.http.token_file = folder_ / "none";
  EXPECT_TRUE(check_secrets(config));
}

class FieldSecrets : public Secrets {};

// The rule of every secret is that of the others.
TEST_F(FieldSecrets, SecretsThatEveryoneMayReadAreRefused) {
  DaemonConfig config;
  config.http.token_file = write("token", kToken);
  config.privacy.target_id = TargetId::kHmac;
  config.privacy.key_file = write("key", kToken);
  config.curve.enabled = true;
  config.curve.secret_file = write("curve", make_curve_keys().secret_key + "\n");
  ASSERT_TRUE(check_secrets(config)) << check_secrets(config).error().message;
  for (const fs::path& file :
       {config.http.token_file, config.privacy.key_file, config.curve.secret_file}) {
    fs::permissions(file, fs::perms(0604));
    const Expected<void> checked = check_secrets(config);
    ASSERT_FALSE(checked) << file;
    EXPECT_THAT(checked.error().message,
                HasSubstr(file.string() + ": everyone on this machine may use this "));
    EXPECT_THAT(checked.error().message, HasSubstr("(chmod 600)"));
    fs::permissions(file, fs::perms(0640));  // as systemd hands credentials over
    EXPECT_TRUE(check_secrets(config)) << file;
  }
}

TEST_F(Secrets, RefusesAShortToken) {
  const Expected<std::string> token = read_http_token(write("token", "0123456789\n"));
  ASSERT_FALSE(token);
  EXPECT_THAT(token.error().message, HasSubstr("16 characters or more"));
  EXPECT_EQ(read_http_token(write("token", std::string(kToken) + "\n")).value(), kToken);
}

}  // namespace
}  // namespace rayloc::secrets_test
