#include "server/base/config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <tuple>
#include <vector>

namespace rmlcell::server {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

// A key with what it takes and what it refuses. `toml` is written as in a file, `text` as in the
// environment or after a flag. Ranges are those that the text of the key tells.
struct KeyCase {
  std::string key;
  std::string toml;
  std::string text;
  std::string printed;  // by --print-config
  std::vector<std::string>
      refused;  // by environment and flags: just outside the range, not a number
  std::vector<std::string> wrong_types;  // by the file
};

std::ostream& operator<<(std::ostream& out, const KeyCase& one) { return out << one.key; }

std::vector<KeyCase> AllKeys() {
  const std::vector<std::string> no_integer = {"\"4\"", "4.0", "true", "[4]", "1979-05-27"};
  const std::vector<std::string> no_number = {"\"4\"", "true", "[4.0]"};
  const std::vector<std::string> no_text = {"4", "4.5", "true", "[\"a\"]", "{a = 1}"};
  const std::vector<std::string> no_list = {"\"a\"", "4", "[4]", "[[\"a\"]]", "[\"a,b\"]"};
  return {
      {"listen.grpc",
       "['127.0.0.1:7', 'unix:/tmp/a']",
       "127.0.0.1:7, unix:/tmp/a",
       R"(["127.0.0.1:7", "unix:/tmp/a"])",
       {},
       no_list},
      {"cell.name", "'Hall 3'", "the \"hall\"", R"("the \"hall\"")", {}, no_text},
      {"listen.web", "'127.0.0.1:8'", "127.0.0.1:8", R"("127.0.0.1:8")", {}, no_text},
      {"web.origins", "['http://a:1']", "http://a:1", R"(["http://a:1"])", {}, no_list},
      {"web.connections_max", "10", "100000", "100000", {"9", "100001", "ten", ""}, no_integer},
      {"state.directory", "'/a b'", "/a \"b\"", R"("/a \"b\"")", {}, no_text},
      {"store.url", "'sqlite:/a'", "sqlite:/b", R"("sqlite:/b")", {}, no_text},
      {"machines.hosts", "'all'", "enabled", R"("enabled")", {"none", "ALL", ""}, no_text},
      {"machines.hosts_max", "0", "10000", "10000", {"-1", "10001"}, no_integer},
      {"workers.count", "-1", "256", "256", {"-2", "257", "2.5", "0x10", " 3"}, no_integer},
      {"workers.paced", "0", "256", "256", {"-1", "257", "2.5"}, no_integer},
      {"workers.program", "'/w'", "/w", R"("/w")", {}, no_text},
      {"workers.join_token", "'t'", "t\\t", R"("t\\t")", {}, no_text},
      {"workers.lease_ms", "500", "600000", "600000", {"499", "600001"}, no_integer},
      {"jobs.attempts", "1", "10", "10", {"0", "11"}, no_integer},
      {"jobs.queued_max", "1", "10000000", "10000000", {"0", "10000001"}, no_integer},
      {"jobs.keep_finished", "0", "10000000", "10000000", {"-1", "10000001"}, no_integer},
      {"limits.message_bytes", "65536", "67108864", "67108864", {"65535", "67108865"}, no_integer},
      {"limits.program_bytes", "1024", "2048", "2048", {"1023", "268435457"}, no_integer},
      {"limits.target_bytes", "1024", "67108864", "67108864", {"1023", "67108865"}, no_integer},
      {"limits.steps", "1", "1000000000000", "1000000000000", {"0", "1000000000001"}, no_integer},
      {"limits.virtual_time_s",
       "0.001",
       "31536000",
       "31536000.0",
       {"0.0009", "31536000.5", "nan", "inf", "a"},
       no_number},
      {"limits.memory_bytes",
       "16777216",
       "1099511627776",
       "1099511627776",
       {"16777215", "1099511627777"},
       no_integer},
      {"limits.processor_s", "0.1", "0.12345", "0.12345", {"0.09", "86400.1"}, no_number},
      {"limits.output_bytes",
       "65536",
       "17179869184",
       "17179869184",
       {"65535", "17179869185"},
       no_integer},
      {"log.level", "'debug'", "off", R"("off")", {"loud", "INFO", ""}, no_text},
      {"log.format", "'text'", "json", R"("json")", {"xml"}, no_text},
      {"log.file", "'/tmp/log'", "/a\tb", R"("/a\u0009b")", {}, no_text},
      {"shutdown.timeout_s", "0", "0.0004", "4e-04", {"-0.1", "60.1"}, no_number},
  };
}

std::string Section(const std::string& key) { return key.substr(0, key.find('.')); }
std::string LastPart(const std::string& key) { return key.substr(key.find('.') + 1); }
std::string FileWith(const std::string& key, const std::string& toml) {
  return "[" + Section(key) + "]\n" + LastPart(key) + " = " + toml + "\n";
}
std::string Variable(const std::string& key) {
  std::string name = "RMLCELL_";
  for (const char c : key) {
    name += c == '.' ? '_' : static_cast<char>(c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c);
  }
  return name;
}
const ConfigKey& KeyOf(const std::string& name) {
  for (const ConfigKey& key : ConfigKeys()) {
    if (key.name == name) return key;
  }
  throw std::runtime_error("no key " + name);
}

class EveryKey : public testing::TestWithParam<KeyCase> {};

// What a file gives is what the same text gives anywhere else.
TEST_P(EveryKey, IsReadFromAFile) {
  Config config;
  const Status read = ReadConfigText(FileWith(GetParam().key, GetParam().toml), "a.toml", config);
  ASSERT_TRUE(read) << read.error().detail;
  Config printed;
  const Status again =
      ReadConfigText(FileWith(GetParam().key, GetParam().printed), "a.toml", printed);
  ASSERT_TRUE(again) << again.error().detail;
  EXPECT_EQ(KeyOf(GetParam().key).get(printed), GetParam().printed);
}

TEST_P(EveryKey, IsReadFromTheEnvironmentAndFromAFlag) {
  Config environment;
  const Status read =
      ReadConfigEnvironment({{Variable(GetParam().key), GetParam().text}}, environment);
  ASSERT_TRUE(read) << read.error().detail;
  EXPECT_EQ(KeyOf(GetParam().key).get(environment), GetParam().printed);
  Config flag;
  ASSERT_TRUE(KeyOf(GetParam().key).set(flag, GetParam().text));
  EXPECT_EQ(KeyOf(GetParam().key).get(flag), GetParam().printed);
}

TEST_P(EveryKey, ChangesNothingElse) {
  Config config;
  ASSERT_TRUE(KeyOf(GetParam().key).set(config, GetParam().text));
  const Config standard;
  for (const ConfigKey& key : ConfigKeys()) {
    if (key.name == GetParam().key) {
      EXPECT_NE(key.get(config), key.get(standard)) << key.name;
    } else {
      EXPECT_EQ(key.get(config), key.get(standard)) << key.name;
    }
  }
}

TEST(Config, TellsAVariableThatIsNearlyAKey) {
  EXPECT_THAT(
      MistypedVariables({{"RMLCELL_WORKER_COUNT", "4"}}),
      testing::ElementsAre(testing::AllOf(testing::StartsWith("RMLCELL_WORKER_COUNT is no key"),
                                          testing::HasSubstr("RMLCELL_WORKERS_"))));
  EXPECT_THAT(MistypedVariables({{"RMLCELL_WORKERS_COUNT", "4"},
                                 {"RMLCELL_LIMITS_MESSAGE_BYTES", "65536"},
                                 {"RMLCELL_CONFIG", "a.toml"},
                                 {"RMLCELL_SERVER", "127.0.0.1:1"},
                                 {"PATH", "/bin"}}),
              testing::IsEmpty());
}

TEST_P(EveryKey, RefusesWhatIsOutOfRangeAndNamesItself) {
  for (const std::string& text : GetParam().refused) {
    Config config;
    const std::string before = KeyOf(GetParam().key).get(config);
    const Status read = ReadConfigEnvironment({{Variable(GetParam().key), text}}, config);
    ASSERT_FALSE(read) << text;
    EXPECT_EQ(read.error().code, ErrorCode::kCellConfiguration);
    EXPECT_THAT(read.error().detail, StartsWith(Variable(GetParam().key) + " "));
    EXPECT_EQ(KeyOf(GetParam().key).get(config), before) << text;
  }
}

TEST_P(EveryKey, RefusesAValueOfAnotherTypeWithItsPlace) {
  for (const std::string& toml : GetParam().wrong_types) {
    Config config;
    const Status read = ReadConfigText(FileWith(GetParam().key, toml), "a.toml", config);
    ASSERT_FALSE(read) << toml;
    EXPECT_EQ(read.error().code, ErrorCode::kCellConfiguration);
    EXPECT_THAT(read.error().detail, StartsWith("a.toml:2:"));
    EXPECT_THAT(read.error().detail, HasSubstr(GetParam().key + " ")) << toml;
  }
}

INSTANTIATE_TEST_SUITE_P(Config, EveryKey, testing::ValuesIn(AllKeys()), [](const auto& one) {
  std::string name = one.param.key;
  name.replace(name.find('.'), 1, "_");
  return name;
});

// Whoever wrote something else hears what may stand there.
TEST(Config, AValueThatIsNoneIsToldWithWhatIsAllowed) {
  const std::vector<std::tuple<std::string, std::string, std::string>> cases = {
      {"shutdown.timeout_s", "soon", "takes a number, not 'soon'"},
      {"shutdown.timeout_s", "61", "is 61, allowed are 0 to 60"},
      {"workers.paced", "two", "takes a whole number, not 'two'"},
      {"log.format", "xml", "is 'xml', allowed are text, json"},
      {"machines.hosts", "none", "is 'none', allowed are all, enabled"}};
  for (const auto& [key, text, said] : cases) {
    Config config;
    const Status set = KeyOf(key).set(config, text);
    ASSERT_FALSE(set) << key;
    EXPECT_EQ(set.error().detail, said);
  }
}

TEST(Config, HasACaseHereForEachKeyAndTellsItsMeaning) {
  std::set<std::string> tested;
  for (const KeyCase& one : AllKeys()) tested.insert(one.key);
  for (const ConfigKey& key : ConfigKeys()) {
    EXPECT_TRUE(tested.contains(std::string(key.name))) << key.name;
    EXPECT_THAT(std::string(key.text), Not(IsEmpty())) << key.name;
  }
  EXPECT_EQ(tested.size(), ConfigKeys().size());
}

TEST(Config, RangesAreInclusiveAtBothEnds) {
  const std::vector<std::pair<std::string, std::pair<std::string, std::string>>> ends = {
      {"web.connections_max", {"10", "100000"}},
      {"workers.count", {"-1", "256"}},
      {"workers.paced", {"0", "256"}},
      {"machines.hosts_max", {"0", "10000"}},
      {"workers.lease_ms", {"500", "600000"}},
      {"jobs.attempts", {"1", "10"}},
      {"limits.virtual_time_s", {"0.001", "31536000"}},
      {"limits.processor_s", {"0.1", "86400"}},
      {"shutdown.timeout_s", {"0", "60"}},
  };
  for (const auto& [key, range] : ends) {
    Config config;
    EXPECT_TRUE(KeyOf(key).set(config, range.first)) << key;
    EXPECT_TRUE(KeyOf(key).set(config, range.second)) << key;
  }
}

TEST(Config, TellsTheLineOfAnUnknownKeyAndTheNearestOne) {
  Config config;
  const Status read = ReadConfigText("[workers]\ncount = 2\nlease_m = 9000\n", "b.toml", config);
  ASSERT_FALSE(read);
  EXPECT_THAT(read.error().detail, StartsWith("b.toml:3:"));
  EXPECT_THAT(read.error().detail, HasSubstr("unknown key workers.lease_m"));
  EXPECT_THAT(read.error().detail, HasSubstr("did you mean workers.lease_ms?"));
  EXPECT_EQ(config.workers_count, -1);  // nothing is changed by a file that is refused
}

TEST(Config, RefusesKeysOutsideSectionsAndUnknownSections) {
  Config config;
  const Status outside = ReadConfigText("count = 2\n", "c.toml", config);
  ASSERT_FALSE(outside);
  EXPECT_THAT(outside.error().detail, StartsWith("c.toml:1:"));
  const Status section = ReadConfigText("[worker]\ncount = 2\n", "c.toml", config);
  ASSERT_FALSE(section);
  EXPECT_THAT(section.error().detail, HasSubstr("unknown key worker.count"));
  EXPECT_FALSE(ReadConfigText("[workers.count]\na = 2\n", "c.toml", config));
}

TEST(Config, TextThatIsNotTomlIsAnErrorWithItsPlace) {
  Config config;
  for (const std::string text :
       {"[workers]\ncount = \n", "[workers]\ncount = 2 2\n", "[workers]\n\""}) {
    const Status read = ReadConfigText(text, "d.toml", config);
    ASSERT_FALSE(read) << text;
    EXPECT_EQ(read.error().code, ErrorCode::kCellConfiguration);
    EXPECT_THAT(read.error().detail, StartsWith("d.toml:2:")) << text;
  }
  EXPECT_FALSE(ReadConfigText("[jobs]\nattempts = 1\n[jobs]\nattempts = 2\n", "d.toml", config));
  EXPECT_FALSE(ReadConfigText("[log]\nfile = \"\xFF\xFE\"\n", "d.toml", config));  // no UTF-8
}

TEST(Config, ReadsFilesAndRefusesWhatIsNone) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("rmlcell-config-" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  const std::string good = (folder / "good.toml").string();
  std::ofstream(good) << "[jobs]\nattempts = 7\n";
  const std::string full = (folder / "full.toml").string();
  std::ofstream(full) << std::string(1 << 20, '\n');
  const std::string large = (folder / "large.toml").string();
  std::ofstream(large) << std::string((1 << 20) + 1, '\n');
  Config config;
  EXPECT_TRUE(ReadConfigFile(full, config));
  EXPECT_TRUE(ReadConfigFile(good, config));
  EXPECT_EQ(config.jobs_attempts, 7);
  // One byte more than is read at a time, and it counts.
  const std::string last = (folder / "last.toml").string();
  const std::string before_last = "[jobs]\nattempts = 1";
  std::ofstream(last) << std::string(4096 - before_last.size(), '\n') << before_last << "0";
  EXPECT_TRUE(ReadConfigFile(last, config));
  EXPECT_EQ(config.jobs_attempts, 10);
  for (const std::string& path : {folder.string(), (folder / "none.toml").string(), large}) {
    const Status read = ReadConfigFile(path, config);
    ASSERT_FALSE(read) << path;
    EXPECT_EQ(read.error().code, ErrorCode::kCellConfiguration);
    EXPECT_THAT(read.error().detail, HasSubstr(path));
  }
  std::filesystem::remove_all(folder);
}

TEST(Config, MachinesOfAFileReplaceThoseThatWereThere) {
  Config config;
  ASSERT_TRUE(
      ReadConfigText("[[machine]]\nid = 'a'\nfamily = 'rml1'\nprofile = 'srm-20'\ntitle = 'A'\n"
                     "[[machine]]\nid = 'b'\nfamily = 'optimo'\n",
                     "e.toml", config));
  ASSERT_EQ(config.machines.size(), 2U);
  EXPECT_EQ(config.machines[0].id, "a");
  EXPECT_EQ(config.machines[0].profile, "srm-20");
  EXPECT_EQ(config.machines[0].title, "A");
  EXPECT_EQ(config.machines[1].family, "optimo");
  ASSERT_TRUE(ReadConfigText("machine = []\n", "e.toml", config));
  EXPECT_THAT(config.machines, IsEmpty());
}

TEST(Config, RefusesMachinesThatAreWrittenWrongly) {
  for (const std::string text :
       {"machine = 3\n", "machine = ['a']\n", "[machine]\nid = 'a'\n", "[[machine]]\nid = 3\n",
        "[[machine]]\nname = 'a'\n", "[[machine]]\nid = 'a'\nparameters = {VMAX = 1}\n"}) {
    Config config;
    const Status read = ReadConfigText(text, "f.toml", config);
    ASSERT_FALSE(read) << text;
    EXPECT_THAT(read.error().detail, HasSubstr("machine")) << text;
    EXPECT_EQ(config.machines.size(), 2U);
  }
}

TEST(Config, PrintedConfigurationReadsBackToTheSame) {
  Config config;
  for (const KeyCase& one : AllKeys()) ASSERT_TRUE(KeyOf(one.key).set(config, one.text)) << one.key;
  config.machines = {{"m-1", "rml1", "srm-20", "one \"and\" \\ only"},
                     {"m-2", "optimo", "", "\x7F\x01"}};
  const std::string printed = PrintConfig(config);
  Config read;
  const Status status = ReadConfigText(printed, "printed", read);
  ASSERT_TRUE(status) << status.error().detail << "\n" << printed;
  EXPECT_EQ(PrintConfig(read), printed);
  for (const KeyCase& one : AllKeys()) {
    EXPECT_EQ(KeyOf(one.key).get(read), one.printed) << one.key;
    EXPECT_THAT(printed, HasSubstr("# " + std::string(KeyOf(one.key).text) + "\n"));
  }
  ASSERT_EQ(read.machines.size(), 2U);
  EXPECT_EQ(read.machines[0].title, config.machines[0].title);
  EXPECT_EQ(read.machines[1].title, config.machines[1].title);
  // People read it: only what is no letter is written as an escape.
  EXPECT_THAT(PrintConfig(Config()), HasSubstr("title = \"Virtual Optimo\"\n"));
  config.machines.clear();
  ASSERT_TRUE(ReadConfigText(PrintConfig(config), "printed", read));
  EXPECT_THAT(read.machines, IsEmpty());
}

TEST(Config, DefaultsAreValidAndPrintBack) {
  const Config standard;
  EXPECT_TRUE(ValidateConfig(standard));
  Config read;
  read.machines.clear();
  ASSERT_TRUE(ReadConfigText(PrintConfig(standard), "printed", read));
  EXPECT_EQ(PrintConfig(read), PrintConfig(standard));
  // conventions.md, service: loopback 50051 and 50080, one machine of each family.
  EXPECT_THAT(standard.listen_grpc, ElementsAre("127.0.0.1:50051"));
  EXPECT_EQ(standard.listen_web, "127.0.0.1:50080");
  ASSERT_EQ(standard.machines.size(), 2U);
  EXPECT_NE(standard.machines[0].family, standard.machines[1].family);
}

// Until there is TLS nobody from another host may call.
TEST(Config, ListensOnLoopbackAndUnixSocketsOnly) {
  for (const std::string good : {"127.0.0.1:1", "127.8.9.10:65535", "localhost:0", "[::1]:50051",
                                 "unix:/run/a.sock", "unix:a"}) {
    Config config;
    config.listen_grpc = {good};
    EXPECT_TRUE(ValidateConfig(config)) << good;
  }
  for (const std::string other :
       {"0.0.0.0:1", "10.0.0.1:1", "[::]:1", "example.com:1", "127.0.0.1.example.com:1",
        "127.evil:1", "126.255.255.255:1", "128.0.0.0:1", "localhost.example.com:1",
        "[::ffff:10.0.0.1]:1", ":1", "::1:1"}) {
    Config config;
    config.listen_grpc = {"127.0.0.1:1", other};
    const Status grpc = ValidateConfig(config);
    ASSERT_FALSE(grpc) << other;
    EXPECT_EQ(grpc.error().code, ErrorCode::kCellUnsafeListen) << other;
    Config web;
    web.listen_web = other;
    ASSERT_FALSE(ValidateConfig(web)) << other;
    EXPECT_EQ(ValidateConfig(web).error().code, ErrorCode::kCellUnsafeListen) << other;
  }
}

TEST(Config, RefusesAddressesThatAreNone) {
  for (const std::string bad : {"", "127.0.0.1", "127.0.0.1:", "127.0.0.1:-1", "127.0.0.1:65536",
                                "127.0.0.1:http", "unix:", "127.0.0.1:99999999999999999999"}) {
    Config config;
    config.listen_grpc = {bad};
    const Status valid = ValidateConfig(config);
    ASSERT_FALSE(valid) << bad;
    EXPECT_EQ(valid.error().code, ErrorCode::kCellConfiguration) << bad;
  }
  Config config;
  config.listen_grpc.clear();
  EXPECT_FALSE(ValidateConfig(config));
  Config unix_web;
  unix_web.listen_web = "unix:/tmp/web";
  EXPECT_FALSE(ValidateConfig(unix_web));
  Config no_web;
  no_web.listen_web.clear();
  EXPECT_TRUE(ValidateConfig(no_web));
}

TEST(Config, RefusesMachineIdsThatAreNoResourceIdsOrStandTwice) {
  const auto with = [](const std::vector<std::string>& ids) {
    Config config;
    config.machines.clear();
    for (const std::string& id : ids)
      config.machines.push_back({.id = id, .family = "rml1", .profile = {}, .title = {}});
    return ValidateConfig(config);
  };
  EXPECT_TRUE(with({"a", "b-2", "z", "za09z-"}));
  for (const char* wrong : {"a/", "a:", "a`", "a{", "-a", "0a", "`a", "{a"})
    EXPECT_FALSE(with({wrong}));
  EXPECT_TRUE(with({"a" + std::string(62, 'b')}));
  EXPECT_FALSE(with({"a" + std::string(63, 'b')}));
  EXPECT_FALSE(with({""}));
  EXPECT_FALSE(with({"A"}));
  EXPECT_FALSE(with({"1a"}));
  EXPECT_FALSE(with({"a/b"}));
  EXPECT_FALSE(with({"a", "b", "a"}));
}

TEST(Config, StateDirectoryFollowsTheEnvironment) {
  EXPECT_EQ(DefaultStateDirectory({{"XDG_STATE_HOME", "/s"}, {"HOME", "/h"}}), "/s/rmlcell");
  EXPECT_EQ(DefaultStateDirectory({{"XDG_STATE_HOME", ""}, {"HOME", "/h"}}),
            "/h/.local/state/rmlcell");
  EXPECT_EQ(DefaultStateDirectory({}), "/var/lib/rmlcell");
}

// A file that says what is not allowed is refused whole, with the line that says it.
TEST(Config, AFileTellsTheLineOfAValueOutOfRange) {
  for (const auto& [line, said] : std::vector<std::pair<std::string, std::string>>{
           {"attempts = 11", "jobs.attempts is 11, allowed are 1 to 10"},
           {"attempts = 0", "jobs.attempts is 0, allowed are 1 to 10"}}) {
    Config config;
    const Status read = ReadConfigText("[jobs]\nqueued_max = 7\n" + line + "\n", "g.toml", config);
    ASSERT_FALSE(read) << line;
    EXPECT_EQ(read.error().code, ErrorCode::kCellConfiguration);
    EXPECT_EQ(read.error().detail, "g.toml:3: " + said);
    EXPECT_EQ(config.jobs_queued_max, Config().jobs_queued_max);
  }
}

}  // namespace
}  // namespace rmlcell::server
