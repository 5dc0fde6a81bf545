#include "server/base/config.h"

#include <arpa/inet.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <set>
#include <sstream>

#include "engine/core/hex.h"
#include "engine/core/letters.h"
#include "engine/core/near_words.h"
#include "engine/core/number_text.h"

namespace rmlcell::server {
namespace {

Error Wrong(const Detail& detail) { return {ErrorCode::kCellConfiguration, detail, {}}; }

// A basic string of TOML, which may hold control characters only as escapes.
std::string Quoted(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7F) {
      out += "\\u00" + HexByte(c);
      continue;
    }
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + '"';
}

Result<std::int64_t> Integer(const std::string& text, std::int64_t low, std::int64_t high) {
  const auto value = ParseInteger(text);
  if (!value) return Wrong("takes a whole number, not '" + text + "'");
  if (*value < low || *value > high) {
    return Wrong("is " + text + ", allowed are " + std::to_string(low) + " to " +
                 std::to_string(high));
  }
  return std::int64_t{*value};
}

Result<double> Number(const std::string& text, double low, double high) {
  const auto value = ParseDouble(text);
  if (!value) return Wrong("takes a number, not '" + text + "'");
  if (!(*value >= low && *value <= high)) {
    return Wrong("is " + text + ", allowed are " + ShortestText(low) + " to " + ShortestText(high));
  }
  return *value;
}

std::vector<std::string> SplitList(const std::string& text) {
  std::vector<std::string> parts;
  std::stringstream stream(text);
  for (std::string part; std::getline(stream, part, ',');) {
    const auto first = part.find_first_not_of(" \t");
    if (first == std::string::npos) continue;
    parts.push_back(part.substr(first, part.find_last_not_of(" \t") - first + 1));
  }
  return parts;
}

std::string ListText(const std::vector<std::string>& parts) {
  std::string out = "[";
  for (const std::string& part : parts) out += (out.size() > 1 ? ", " : "") + Quoted(part);
  return out + "]";
}

// A float of TOML, with every digit that reads back to the same value.
std::string NumberText(double value) {
  std::string text = ShortestText(value);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

Status OneOf(const std::string& text, std::initializer_list<std::string_view> words,
             std::string& target) {
  if (std::ranges::find(words, text) == words.end()) {
    std::string all;
    for (const std::string_view word : words) all += (all.empty() ? "" : ", ") + std::string(word);
    return Wrong("is '" + text + "', allowed are " + all);
  }
  target = text;
  return {};
}

// The setters and getters of one member, so that the table below stays one line a key.
#define RMLCELL_INTEGER(member, low, high)                    \
  ConfigKind::kInteger,                                       \
      [](Config& config, const std::string& text) -> Status { \
        const auto value = Integer(text, low, high);          \
        if (!value) return value.error();                     \
        config.member = *value;                               \
        return {};                                            \
      },                                                      \
      [](const Config& config) { return std::to_string(config.member); }
#define RMLCELL_NUMBER(member, low, high)                     \
  ConfigKind::kNumber,                                        \
      [](Config& config, const std::string& text) -> Status { \
        const auto value = Number(text, low, high);           \
        if (!value) return value.error();                     \
        config.member = *value;                               \
        return {};                                            \
      },                                                      \
      [](const Config& config) { return NumberText(config.member); }
#define RMLCELL_TEXT(member)                                  \
  ConfigKind::kText,                                          \
      [](Config& config, const std::string& text) -> Status { \
        config.member = text;                                 \
        return {};                                            \
      },                                                      \
      [](const Config& config) { return Quoted(config.member); }
#define RMLCELL_LIST(member)                                  \
  ConfigKind::kList,                                          \
      [](Config& config, const std::string& text) -> Status { \
        config.member = SplitList(text);                      \
        return {};                                            \
      },                                                      \
      [](const Config& config) { return ListText(config.member); }
#define RMLCELL_WORD(member, ...)                             \
  ConfigKind::kText,                                          \
      [](Config& config, const std::string& text) -> Status { \
        return OneOf(text, {__VA_ARGS__}, config.member);     \
      },                                                      \
      [](const Config& config) { return Quoted(config.member); }

constexpr std::int64_t kMiB = 1 << 20;
constexpr std::size_t kFileBytesMax = 1 << 20;  // a configuration has some kilobytes

std::vector<ConfigKey> MakeKeys() {
  return {
      {"cell.name", "what the cell is called, for people; may be empty", RMLCELL_TEXT(cell_name)},
      {"listen.grpc", "gRPC addresses: host:port or unix:/path; loopback and unix sockets only",
       RMLCELL_LIST(listen_grpc)},
      {"listen.web",
       "web address host:port (page, JSON, gRPC-Web, event streams); empty: none; loopback only",
       RMLCELL_TEXT(listen_web)},
      {"web.origins", "other web origins that may call the web port, such as http://localhost:5173",
       RMLCELL_LIST(web_origins)},
      {"web.connections_max", "open web connections, 10 to 100000",
       RMLCELL_INTEGER(web_connections_max, 10, 100'000)},
      {"state.directory",
       "where the store is kept; empty: $XDG_STATE_HOME/rmlcell or ~/.local/state/rmlcell",
       RMLCELL_TEXT(state_directory)},
      {"store.url", "the store: sqlite:/path/of/cell.db; empty: cell.db in state.directory",
       RMLCELL_TEXT(store_url)},
      {"machines.hosts",
       "which virtual machines live when nobody has said so: all, or those that are enabled",
       RMLCELL_WORD(machines_hosts, "all", "enabled")},
      {"machines.hosts_max", "machines that live at the same time, 0 to 10000",
       RMLCELL_INTEGER(machines_hosts_max, 0, 10'000)},
      {"workers.count",
       "engine workers that the server starts, 0 to 256; -1: one per processor core",
       RMLCELL_INTEGER(workers_count, -1, 256)},
      {"workers.paced",
       "further workers for simulations with a pace, 0 to 256; none without workers.count",
       RMLCELL_INTEGER(workers_paced, 0, 256)},
      {"workers.program", "path of rmlcell-worker; empty: beside the server",
       RMLCELL_TEXT(workers_program)},
      {"workers.join_token", "what a worker must know to join; empty: made anew at each start",
       RMLCELL_TEXT(workers_join_token)},
      {"workers.lease_ms",
       "how long a worker may be silent before its job is given to another, 500 to 600000 ms",
       RMLCELL_INTEGER(workers_lease_ms, 500, 600'000)},
      {"jobs.attempts", "how often a job is tried when its worker dies, 1 to 10",
       RMLCELL_INTEGER(jobs_attempts, 1, 10)},
      {"jobs.queued_max", "jobs that may wait, 1 to 10000000; more are refused",
       RMLCELL_INTEGER(jobs_queued_max, 1, 10'000'000)},
      {"jobs.keep_finished",
       "finished jobs that are kept with their events and products, 0 to 10000000; 0: all",
       RMLCELL_INTEGER(jobs_keep_finished, 0, 10'000'000)},
      {"limits.message_bytes", "largest message of a call, 65536 to 67108864 bytes",
       RMLCELL_INTEGER(limit_message_bytes, 65'536, 64 * kMiB)},
      {"limits.program_bytes", "largest program, 1024 to 268435456 bytes",
       RMLCELL_INTEGER(limit_program_bytes, 1024, 256 * kMiB)},
      {"limits.target_bytes", "largest target of a job, 1024 to 67108864 bytes",
       RMLCELL_INTEGER(limit_target_bytes, 1024, 64 * kMiB)},
      {"limits.steps", "executed steps of a job, 1 to 10^12",
       RMLCELL_INTEGER(limit_steps, 1, 1'000'000'000'000)},
      {"limits.virtual_time_s", "virtual time of a job, 0.001 to 31536000 s",
       RMLCELL_NUMBER(limit_virtual_time_s, 0.001, 31'536'000.0)},
      {"limits.memory_bytes", "memory of a job in its worker, 16777216 bytes (16 MiB) to 1 TiB",
       RMLCELL_INTEGER(limit_memory_bytes, 16 * kMiB, std::int64_t{1} << 40)},
      {"limits.processor_s", "processor time of a job, 0.1 to 86400 s",
       RMLCELL_NUMBER(limit_processor_s, 0.1, 86'400.0)},
      {"limits.output_bytes",
       "report, trace, toolpath, pictures and events of a job, 65536 bytes to 16 GiB",
       RMLCELL_INTEGER(limit_output_bytes, 65'536, std::int64_t{16} << 30)},
      {"log.level", "trace, debug, info, warning, error or off",
       RMLCELL_WORD(log_level, "trace", "debug", "info", "warning", "error", "off")},
      {"log.format", "text or json", RMLCELL_WORD(log_format, "text", "json")},
      {"log.file", "file to write the log to; empty: standard error", RMLCELL_TEXT(log_file)},
      {"shutdown.timeout_s", "how long a stop waits for calls that run, 0 to 60 s",
       RMLCELL_NUMBER(shutdown_timeout_s, 0.0, 60.0)},
  };
}

const ConfigKey* FindKey(std::string_view name) {
  const auto& keys = ConfigKeys();
  const auto found =
      std::ranges::find_if(keys, [&](const ConfigKey& key) { return key.name == name; });
  return found == keys.end() ? nullptr : &*found;
}

// What a value of TOML is, for people.
std::string_view TypeName(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::string:
      return "a text";
    case toml::node_type::integer:
      return "a whole number";
    case toml::node_type::floating_point:
      return "a number";
    case toml::node_type::boolean:
      return "a truth value";
    case toml::node_type::array:
      return "a list";
    case toml::node_type::table:
      return "a section";
    default:
      return "a date or time";
  }
}

// The TOML value as the text that a setter takes.
Result<std::string> ValueText(const toml::node& node, ConfigKind kind) {
  switch (kind) {
    case ConfigKind::kInteger:
      if (const auto* integer = node.as_integer()) return std::to_string(integer->get());
      return Wrong("takes a whole number, not " + std::string(TypeName(node)));
    case ConfigKind::kNumber:
      if (const auto* integer = node.as_integer()) return std::to_string(integer->get());
      if (const auto* number = node.as_floating_point()) return ShortestText(number->get());
      return Wrong("takes a number, not " + std::string(TypeName(node)));
    case ConfigKind::kText:
      if (const auto* text = node.as_string()) return text->get();
      return Wrong("takes a text, not " + std::string(TypeName(node)));
    case ConfigKind::kList:
      break;
  }
  const auto* list = node.as_array();
  if (list == nullptr) return Wrong("takes a list of texts, not " + std::string(TypeName(node)));
  std::string joined;
  for (const toml::node& item : *list) {
    const auto* text = item.as_string();
    if (text == nullptr)
      return Wrong("takes a list of texts; one of them is " + std::string(TypeName(item)));
    // The environment and the flags have no other way to separate the parts of a list.
    if (text->get().find(',') != std::string::npos)
      return Wrong("has a comma in '" + text->get() + "'");
    joined += (joined.empty() ? "" : ",") + text->get();
  }
  return joined;
}

std::string PlaceText(const std::string& file, const toml::node& node) {
  return file + ":" + std::to_string(node.source().begin.line) + ": ";
}

constexpr std::string_view kVariablePrefix = "RMLCELL_";

// "workers.count" is RMLCELL_WORKERS_COUNT.
std::string VariableOf(std::string_view key) {
  std::string variable(kVariablePrefix);
  for (const char c : key) {
    variable += c == '.' ? '_' : UpperCase(c);
  }
  return variable;
}

// The keys that may be meant.
std::vector<std::string> NearKeys(std::string_view name) {
  std::vector<std::string_view> keys;
  for (const ConfigKey& key : ConfigKeys()) keys.push_back(key.name);
  return NearestTo(name, keys).words;
}

Status ReadMachine(const toml::table& table, const std::string& file,
                   std::vector<MachineConfig>& machines) {
  MachineConfig machine;
  for (const auto& [key, node] : table) {
    const auto* text = node.as_string();
    if (text == nullptr)
      return Wrong(PlaceText(file, node) + "machine." + std::string(key) + " takes a text");
    if (key == "id") {
      machine.id = text->get();
    } else if (key == "family") {
      machine.family = text->get();
    } else if (key == "profile") {
      machine.profile = text->get();
    } else if (key == "title") {
      machine.title = text->get();
    } else {
      return Wrong(PlaceText(file, node) + "unknown key machine." + std::string(key) +
                   "; there are id, family, profile, title");
    }
  }
  machines.push_back(std::move(machine));
  return {};
}

Status ApplyTable(const toml::table& parsed, const std::string& name, Config& config) {
  Config changed = config;
  for (const auto& [section_key, section] : parsed) {
    const std::string section_name(section_key);
    if (section_name == "machine") {
      const auto* list = section.as_array();
      if (list == nullptr || (!list->empty() && !list->is_homogeneous<toml::table>())) {
        return Wrong(PlaceText(name, section) + "write machines as [[machine]] tables");
      }
      changed.machines.clear();
      for (const toml::node& node : *list) {
        if (const Status read = ReadMachine(*node.as_table(), name, changed.machines); !read)
          return read.error();
      }
      continue;
    }
    const auto* table = section.as_table();
    if (table == nullptr) {
      return Wrong(PlaceText(name, section) + "unknown key " + section_name +
                   "; keys stand in sections");
    }
    for (const auto& [key, node] : *table) {
      const std::string full = section_name + "." + std::string(key);
      const ConfigKey* found = FindKey(full);
      if (found == nullptr) {
        return Wrong(PlaceText(name, node) + "unknown key " + full + DidYouMean(NearKeys(full)));
      }
      const auto value = ValueText(node, found->kind);
      if (!value) return Wrong(PlaceText(name, node) + full + " " + value.error().detail);
      const Status set = found->set(changed, *value);
      if (!set) return Wrong(PlaceText(name, node) + full + " " + set.error().detail);
    }
  }
  config = std::move(changed);
  return {};
}

// By the address, not by its look: a name such as 127.0.0.1.example may lead anywhere.
bool IsLoopback(const std::string& host) {
  if (host == "localhost" || host == "[::1]") return true;
  in_addr address{};
  return ::inet_pton(AF_INET, host.c_str(), &address) == 1 && (ntohl(address.s_addr) >> 24) == 127;
}

Status ValidateAddress(std::string_view key, const std::string& address) {
  if (address.starts_with("unix:") && key == "listen.grpc") {
    if (address.size() > 5) return {};
    return Wrong(std::string(key) + " names no socket file after unix:");
  }
  const std::size_t colon = address.rfind(':');
  const auto port =
      colon == std::string::npos ? std::nullopt : ParseInteger(address.substr(colon + 1));
  if (!port || *port < 0 || *port > 65535) {
    return Wrong(std::string(key) + " is '" + address +
                 "': write host:port with a port from 0 to 65535");
  }
  if (!IsLoopback(address.substr(0, colon))) {
    return Error{ErrorCode::kCellUnsafeListen, std::string(key) + " is '" + address + "'", {}};
  }
  return {};
}

bool IsResourceId(std::string_view id) {
  if (id.empty() || id.size() > 63 || id.front() < 'a' || id.front() > 'z') return false;
  return std::ranges::all_of(
      id, [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-'; });
}

}  // namespace

const std::vector<ConfigKey>& ConfigKeys() {
  static const std::vector<ConfigKey> keys = MakeKeys();
  return keys;
}

// toml++ throws on text that is not TOML; nothing else of it leaves this file.
Status ReadConfigText(std::string_view text, const std::string& name, Config& config) {
  try {
    return ApplyTable(toml::parse(text, name), name, config);
  } catch (const toml::parse_error& error) {
    return Wrong(name + ":" + std::to_string(error.source().begin.line) + ":" +
                 std::to_string(error.source().begin.column) + ": " +
                 std::string(error.description()));
  }
}

Status ReadConfigFile(const std::string& path, Config& config) {
  const auto unreadable = [&](const std::string& why) {
    return Wrong("cannot read " + path + ": " + why);
  };
  std::FILE* file = std::fopen(path.c_str(), "rb");
  if (file == nullptr) return unreadable(std::strerror(errno));
  std::string text;
  char room[4096];
  for (std::size_t n = 0;
       (n = std::fread(room, 1, sizeof room, file)) > 0 && text.size() <= kFileBytesMax;) {
    text.append(room, n);
  }
  const int failed = std::ferror(file) != 0 ? errno : 0;  // a directory can be opened, not read
  std::fclose(file);
  if (failed != 0) return unreadable(std::strerror(failed));
  if (text.size() > kFileBytesMax) return unreadable("it is longer than 1 MiB, no configuration");
  return ReadConfigText(text, path, config);
}

Status ReadConfigEnvironment(const std::map<std::string, std::string>& environment,
                             Config& config) {
  for (const ConfigKey& key : ConfigKeys()) {
    const std::string variable = VariableOf(key.name);
    const auto found = environment.find(variable);
    if (found == environment.end()) continue;
    const Status set = key.set(config, found->second);
    if (!set) return Wrong(variable + " " + set.error().detail);
  }
  return {};
}

std::vector<std::string> MistypedVariables(const std::map<std::string, std::string>& environment) {
  std::vector<std::string> found;
  for (const auto& [variable, value] : environment) {
    if (!variable.starts_with(kVariablePrefix)) continue;
    std::string name = LowerCase(std::string_view(variable).substr(kVariablePrefix.size()));
    const std::size_t section = name.find('_');
    if (section != std::string::npos) name[section] = '.';
    if (FindKey(name) != nullptr) continue;
    if (const std::vector<std::string> near = NearKeys(name); !near.empty()) {
      found.push_back(variable + " is no key of the configuration; there is " +
                      VariableOf(near.front()));
    }
  }
  return found;
}

Status ValidateConfig(const Config& config) {
  if (config.listen_grpc.empty()) return Wrong("listen.grpc is empty: nobody could call");
  for (const std::string& address : config.listen_grpc) {
    if (const Status valid = ValidateAddress("listen.grpc", address); !valid) return valid.error();
  }
  if (!config.listen_web.empty()) {
    if (const Status valid = ValidateAddress("listen.web", config.listen_web); !valid)
      return valid.error();
  }
  std::set<std::string> ids;
  for (const MachineConfig& machine : config.machines) {
    if (!IsResourceId(machine.id)) {
      return Wrong("machine id '" + machine.id +
                   "': use a-z, 0-9 and '-', beginning with a letter, at most 63");
    }
    if (!ids.insert(machine.id).second)
      return Wrong("machine id '" + machine.id + "' stands twice");
  }
  return {};
}

std::string PrintConfig(const Config& config) {
  std::string out;
  if (config.machines.empty()) out = "# no virtual machine is made\nmachine = []\n";
  std::string section;
  for (const ConfigKey& key : ConfigKeys()) {
    const std::size_t dot = key.name.find('.');
    if (key.name.substr(0, dot) != section) {
      section = key.name.substr(0, dot);
      out += (out.empty() ? "[" : "\n[") + section + "]\n";
    }
    out += "# " + std::string(key.text) + "\n";
    out += std::string(key.name.substr(dot + 1)) + " = " + key.get(config) + "\n";
  }
  for (const MachineConfig& machine : config.machines) {
    out += "\n# a virtual machine, made when the store has none of this id\n[[machine]]\n";
    out += "id = " + Quoted(machine.id) + "\nfamily = " + Quoted(machine.family) +
           "\nprofile = " + Quoted(machine.profile) + "\ntitle = " + Quoted(machine.title) + "\n";
  }
  return out;
}

std::string DefaultStateDirectory(const std::map<std::string, std::string>& environment) {
  const auto value = [&](const char* name) {
    const auto found = environment.find(name);
    return found == environment.end() ? std::string() : found->second;
  };
  if (const std::string state = value("XDG_STATE_HOME"); !state.empty()) return state + "/rmlcell";
  if (const std::string home = value("HOME"); !home.empty()) return home + "/.local/state/rmlcell";
  return "/var/lib/rmlcell";
}

}  // namespace rmlcell::server
