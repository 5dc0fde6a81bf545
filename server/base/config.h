#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "engine/core/result.h"

namespace rmlcell::server {

// A virtual machine that the server makes when its store has none of that id.
struct MachineConfig {
  std::string id;
  std::string family;
  std::string profile;
  std::string title;
};

// Everything that can be set. Defaults are those of a server started with no configuration at all.
struct Config {
  std::string cell_name;                                       // for people; may be empty
  std::vector<std::string> listen_grpc = {"127.0.0.1:50051"};  // host:port or unix:/path
  std::string listen_web = "127.0.0.1:50080";                  // empty: no web port
  std::vector<std::string> web_origins;  // other pages that may call, for CORS
  std::int64_t web_connections_max = 2000;

  std::string state_directory;  // empty: $XDG_STATE_HOME/rmlcell, or ~/.local/state/rmlcell
  std::string store_url;        // "sqlite:/path/of/cell.db"; empty: cell.db in state_directory

  std::string machines_hosts = "all";     // virtual machines that live: all, enabled
  std::int64_t machines_hosts_max = 100;  // at the same time
  std::int64_t workers_count = -1;        // -1: one per processor core; 0: none of its own
  std::int64_t workers_paced = 4;         // further ones, for simulations with a pace
  std::string workers_program;            // empty: rmlcell-worker beside the server
  std::string workers_join_token;  // empty: made anew at each start, known to its own workers only
  std::int64_t workers_lease_ms = 10'000;

  std::int64_t jobs_attempts = 2;
  std::int64_t jobs_queued_max = 100'000;
  std::int64_t jobs_keep_finished = 100'000;

  std::int64_t limit_message_bytes = 4 << 20;
  std::int64_t limit_program_bytes = 256 << 20;
  std::int64_t limit_target_bytes = 16 << 20;
  std::int64_t limit_steps = 1'000'000'000;
  double limit_virtual_time_s = 30.0 * 24 * 3600;
  std::int64_t limit_memory_bytes = 1LL << 30;
  double limit_processor_s = 600.0;
  std::int64_t limit_output_bytes = 256 << 20;

  std::string log_level = "info";
  std::string log_format = "text";
  std::string log_file;  // empty: standard error

  double shutdown_timeout_s = 3.5;

  std::vector<MachineConfig> machines = {{"optimo-1", "optimo", "", "Virtual Optimo"},
                                         {"mill-1", "rml1", "srm-20", "Virtual SRM-20"}};
};

// One key of the configuration: how it is called everywhere and what it means. The same table reads
// the file, the environment and the flags, checks, prints, and makes docs/configuration.md.
enum class ConfigKind { kInteger, kNumber, kText, kList };
struct ConfigKey {
  std::string_view
      name;  // "workers.count"; environment RMLCELL_WORKERS_COUNT; flag --workers.count
  std::string_view text;  // meaning, unit and range
  ConfigKind kind;        // in the file; environment and flags give text, lists with commas
  Status (*set)(Config& config, const std::string& text);
  std::string (*get)(const Config& config);  // as TOML value
};
const std::vector<ConfigKey>& ConfigKeys();

// The file is TOML. Unknown keys, wrong types and values out of range are errors with line and key;
// nothing is changed then. A file with machines replaces those that were there; `machine = []`
// leaves none. Error: CellConfiguration, as in all of this file but ValidateConfig.
Status ReadConfigFile(const std::string& path, Config& config);
Status ReadConfigText(std::string_view text, const std::string& name, Config& config);

// Variables RMLCELL_<KEY> with dots as underscores, in capitals. Errors name the variable.
Status ReadConfigEnvironment(const std::map<std::string, std::string>& environment, Config& config);

// Variables that look like one of those and are none, such as RMLCELL_WORKER_COUNT, each with what
// was meant: a typing error must not leave a limit at its default in silence.
std::vector<std::string> MistypedVariables(const std::map<std::string, std::string>& environment);

// What holds together only as a whole: addresses that may be listened on, machine ids.
// Errors: CellConfiguration; CellUnsafeListen for an address that other hosts can reach.
Status ValidateConfig(const Config& config);

// The effective configuration as a file that reads back to the same, with a comment for each key.
std::string PrintConfig(const Config& config);

// $XDG_STATE_HOME/rmlcell and so on; `environment` as above.
std::string DefaultStateDirectory(const std::map<std::string, std::string>& environment);

}  // namespace rmlcell::server
