#include "server/cell/cell.h"

#include <absl/synchronization/mutex.h>
#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/grpcpp.h>
#include <grpcpp/health_check_service_interface.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <thread>

#include "engine/core/hex.h"
#include "engine/core/number_text.h"
#include "proto/bridge/findings.h"
#include "server/base/credentials.h"
#include "server/base/executor.h"
#include "server/base/secret.h"
#include "server/cell/private_socket.h"
#include "server/cell/socket_listener.h"
#include "server/events/event_feed.h"
#include "server/jobs/dispatcher.h"
#include "server/jobs/job_book.h"
#include "server/jobs/worker_processes.h"
#include "server/machines/host_processes.h"
#include "server/machines/hosts.h"
#include "server/machines/machine_statuses.h"
#include "server/programs/language_tools.h"
#include "server/programs/memory_tools.h"
#include "server/programs/program_book.h"
#include "server/projects/project_book.h"
#include "server/projects/project_transfer.h"
#include "server/records/job_messages.h"
#include "server/records/machine_messages.h"
#include "server/records/machine_options.h"
#include "server/records/program_memory.h"
#include "server/results/job_results.h"
#include "server/runs/run_products.h"
#include "server/runs/run_queue.h"
#include "server/services/account_service.h"
#include "server/services/cell_service.h"
#include "server/services/foreign_calls.h"
#include "server/services/handbox_service.h"
#include "server/services/host_service.h"
#include "server/services/job_service.h"
#include "server/services/machine_service.h"
#include "server/services/program_service.h"
#include "server/services/project_service.h"
#include "server/services/web_resources.h"
#include "server/services/worker_service.h"
#include "server/web/web_server.h"
#include "storage/opening/open_store.h"

namespace rmlcell::server {
namespace {

// RUN jobs whose time has come, or that another server took.
constexpr std::chrono::seconds kRunsLookedForAfter{1};
// Threads for work that may block: the store mostly, so there are more of them than cores.
constexpr int kStoreThreads = 8;
// For watches, which mostly tell what is in memory: however many there are, calls go on beside
// them.
constexpr int kWatchThreads = 2;
// Programs that may wait to be translated or compared, each with its bytes in memory.
constexpr std::size_t kComputeWaitingMax = 64;

// Events that tell of machines, programs, schedules and projects; who comes back after more of them
// begins with a snapshot.
constexpr std::int64_t kRecordEventsKept = 10'000;

// What the log of the store grows to between two checkpoints of a cell that is not busy.
constexpr std::int64_t kLogBytesPrepared = 17 << 20;

// A host that lives finds a server that was started again within this time.
constexpr std::chrono::milliseconds kHostsComeBack{2'000};

// Keepalive for shop-floor networks: a client that is gone without a word is noticed within a
// minute.
constexpr int kKeepaliveTime_ms = 40'000;
constexpr int kKeepaliveTimeout_ms = 15'000;

std::string PathOfOwnProgram() {
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  return error ? std::string() : self.parent_path().string();
}

bool IsUnixSocket(const std::string& address) { return address.starts_with("unix:"); }

Error PortUsed(const std::string& address) {
  return {ErrorCode::kCellPortUsed, "cannot listen on " + address, {}};
}

}  // namespace

struct Cell::Parts {
  explicit Parts(const Config& configuration) : config(configuration) {}

  Config config;
  std::string instance_id = RandomText();
  std::unique_ptr<storage::Store> store;
  std::unique_ptr<Executor> executor;
  std::unique_ptr<Executor> watching;
  std::unique_ptr<Executor> compute;
  std::unique_ptr<EventFeed> feed;
  std::unique_ptr<Hosts> hosts;
  std::unique_ptr<RunQueue> runs;
  std::unique_ptr<RunProducts> run_products;
  std::unique_ptr<HostProcesses> host_processes;
  std::unique_ptr<MachineStatuses> statuses;
  std::unique_ptr<Dispatcher> dispatcher;
  OpenStreams open;
  Gate gate{RandomText()};
  std::unique_ptr<JobBook> book;
  std::unique_ptr<ProgramBook> programs;
  std::unique_ptr<MemoryTools> tools;
  std::unique_ptr<JobResults> results;
  std::unique_ptr<LanguageTools> language;
  std::unique_ptr<ProjectBook> projects;
  std::unique_ptr<ProjectTransfer> transfer;
  std::unique_ptr<JobService> job_service;
  std::unique_ptr<MachineService> machine_service;
  std::unique_ptr<ProgramService> program_service;
  std::unique_ptr<ProjectService> project_service;
  std::unique_ptr<HandboxService> handbox_service;
  std::unique_ptr<HostService> host_service;
  std::unique_ptr<JobFactsBook> facts;
  std::unique_ptr<SharedLogs> logs;
  WatchRegistry watches;
  std::unique_ptr<CellService> cell_service;
  std::unique_ptr<AccountService> account_service;
  std::unique_ptr<WorkerService> worker_service;
  std::unique_ptr<WebResources> resources;
  std::unique_ptr<grpc::Server> server;
  std::vector<std::unique_ptr<SocketListener>> sockets;  // behind it: they hand connections over
  std::unique_ptr<web::WebServer> web;
  std::unique_ptr<WorkerProcesses> processes;
  std::optional<PrivateSocket> private_socket;
  std::vector<std::string> grpc_addresses;

  Status OpenStore();
  Status MakeMachines();
  Status Listen(const std::string& join_token);
  void MakeHosts(const std::string& host_token);
  Status Serve();
  Status ListenAt(const std::string& address);
  Status ListenWeb();
  Status StartWorkers(const std::string& join_token);
  Status StartHosts();
  std::function<void()> LookAtMachines();
  std::string WorkerProgram() const;
};

std::string Cell::Parts::WorkerProgram() const {
  return config.workers_program.empty() ? PathOfOwnProgram() + "/rmlcell-worker"
                                        : config.workers_program;
}

Status Cell::Parts::OpenStore() {
  auto opened = storage::OpenStore({.url = config.store_url,
                                    .directory = config.state_directory,
                                    .keep_finished_jobs = config.jobs_keep_finished,
                                    .keep_record_events = kRecordEventsKept,
                                    .log_bytes_prepared = kLogBytesPrepared,
                                    .program_memory = LimitOfMemory});
  if (!opened) {
    Error error = opened.error();
    if (error.code == ErrorCode::kCellStoreCorrupt) {
      error.detail +=
          "; the server does not start with it. Use another state.directory for an empty store";
    }
    return error;
  }
  store = std::move(*opened);
  return MakeMachines();
}

// The machines of the configuration that the store does not have yet.
Status Cell::Parts::MakeMachines() {
  for (const MachineConfig& machine : config.machines) {
    const storage::MachineRecord record{.id = machine.id,
                                        .family = machine.family,
                                        .title = machine.title,
                                        .profile = machine.profile};
    if (const Status good = CheckMachine(record); !good) {
      return Error{
          ErrorCode::kCellConfiguration, "machine " + machine.id + ": " + good.error().detail, {}};
    }
    const auto stored = store->PutMachine(record, 0);
    if (stored) continue;
    if (stored.error().code != ErrorCode::kCellAlreadyExists) return stored.error();
    const auto there = store->GetMachine(machine.id);
    if (!there) return there.error();
    if (there->family != record.family || there->profile != record.profile) {
      spdlog::warn(
          "machine {} is in the store as {} {}, and the configuration says {} {}: the store counts",
          machine.id, there->family, there->profile, record.family, record.profile);
    }
  }
  return {};
}

// Machines that live, their hosts, and jobs that run on them.
void Cell::Parts::MakeHosts(const std::string& host_token) {
  hosts = std::make_unique<Hosts>(Hosts::Needs{.store = *store,
                                               .feed = *feed,
                                               .executor = *executor,
                                               .server = instance_id,
                                               .join_token = host_token});
  runs = std::make_unique<RunQueue>(RunQueue::Needs{.store = *store,
                                                    .hosts = *hosts,
                                                    .config = config,
                                                    .executor = *executor,
                                                    .server = instance_id});
  hosts->OnAwaited([this](const std::string& machine) {
    return host_processes != nullptr && host_processes->IsEnabled(machine);
  });
  hosts->OnNews([this](const std::string& machine) { runs->Wake(machine); });
  run_products = std::make_unique<RunProducts>(
      RunProducts::Needs{.store = *store,
                         .hosts = *hosts,
                         .program = WorkerProgram(),
                         .folder = config.state_directory + "/products",
                         .log_level = config.log_level,
                         .log_format = config.log_format});
  hosts->OnRunOver([this](const std::string& machine) { run_products->Look(machine); });
  host_processes = std::make_unique<HostProcesses>(HostProcesses::Options{
      .program = WorkerProgram(),
      .server = private_socket->address(),
      .join_token = host_token,
      .journals = config.state_directory + "/hosts",
      .most = static_cast<std::size_t>(config.machines_hosts_max),
      .log_level = config.log_level,
      .log_format = config.log_format,
      .is_heard = [this](const std::string& machine) { return hosts->IsHeard(machine); },
      .look = LookAtMachines(),
      .gave_up =
          [this](const std::string& machine, const std::string& why) {
            // A person may have enabled it meanwhile, or an older host have come back.
            if (!hosts->IsHeard(machine) && !host_processes->IsEnabled(machine))
              hosts->NoteOff(machine, why);
          }});
}

Status Cell::Parts::Listen(const std::string& join_token) {
  executor = std::make_unique<Executor>(kStoreThreads);
  watching = std::make_unique<Executor>(kWatchThreads);
  compute = std::make_unique<Executor>(
      std::max(1, static_cast<int>(std::thread::hardware_concurrency())), kComputeWaitingMax);
  feed = std::make_unique<EventFeed>(*store);
  Result<PrivateSocket> own = PrivateSocket::Make(config.state_directory);
  if (!own) return own.error();
  private_socket.emplace(*std::move(own));
  const Result<std::string> host_token = KeptSecret(config.state_directory + "/host.token");
  if (!host_token) return host_token.error();
  MakeHosts(*host_token);
  statuses = std::make_unique<MachineStatuses>(*store, *feed, *executor, hosts.get());
  dispatcher = std::make_unique<Dispatcher>(*store, *feed, config, *executor, join_token);
  book = std::make_unique<JobBook>(*store, config);
  book->OnRunWaits([this](const std::string& machine) { runs->Wake(machine); });
  book->OnToldToWait([this](v1::Job& job) { runs->TellWhyItWaits(job); },
                     [this](std::function<void()> work) { executor->Post(std::move(work)); });
  programs = std::make_unique<ProgramBook>(*store, config);
  tools = std::make_unique<MemoryTools>(*store, *programs);
  results = std::make_unique<JobResults>(*store, *book, *tools);
  language = std::make_unique<LanguageTools>(*store, *programs);
  projects = std::make_unique<ProjectBook>(*store);
  transfer = std::make_unique<ProjectTransfer>(*store, *projects, *programs);
  gate.OnChange([this] { open.AskAgain(); });
  const CallNeeds needs{gate, *executor, *compute, config.limit_message_bytes};
  job_service = std::make_unique<JobService>(needs, *watching, *book, *results, *dispatcher, *runs,
                                             *feed, open, instance_id);
  MachineWatchNeeds machine_watch{*watching, open, *store, *feed, instance_id};
  machine_watch.hosts = hosts.get();
  machine_service = std::make_unique<MachineService>(
      needs, std::move(machine_watch),
      MachineService::Live{.hosts = hosts.get(),
                           .processes = host_processes.get(),
                           .runs = runs.get(),
                           .by_default = config.machines_hosts == "all"});
  programs->OnInUse([this](const std::string& machine, int slot) {
    const auto status = hosts->StatusOf(machine);
    return status && std::ranges::find(status->run().loaded_programs(), slot) !=
                         status->run().loaded_programs().end();
  });
  programs->OnStored([this] { hosts->TakeStored(); });
  program_service =
      std::make_unique<ProgramService>(needs, *store, *programs, *tools, *language, open);
  project_service = std::make_unique<ProjectService>(needs, *projects, *transfer, open);
  handbox_service = std::make_unique<HandboxService>(
      needs, HandboxWatchNeeds{*watching, open, *store, *feed, hosts.get()});
  host_service = std::make_unique<HostService>(needs, *hosts);
  facts = std::make_unique<JobFactsBook>(*store);
  const CellRecords records{*store, *book, *programs, *projects, hosts.get()};
  logs = std::make_unique<SharedLogs>(SharedLogNeeds{records, *feed, *facts, instance_id});
  cell_service = std::make_unique<CellService>(
      needs, CellWatchNeeds{*watching, open, records, *feed, *logs, *facts, watches, instance_id},
      *dispatcher, config);
  account_service = std::make_unique<AccountService>(needs);
  worker_service = std::make_unique<WorkerService>(needs, *dispatcher);

  return Serve();
}

Status Cell::Parts::Serve() {
  // Debian builds Abseil with a search for cycles at each lock of gRPC's: with a thousand
  // connections it took 5 % of the server's time.
  absl::SetMutexDeadlockDetectionMode(absl::OnDeadlockCycle::kIgnore);
  grpc::EnableDefaultHealthCheckService(true);
  grpc::reflection::InitProtoReflectionServerBuilderPlugin();
  grpc::ServerBuilder builder;
  AdmitForeignCalls(builder, [this](const CallFacts& call) { return gate.Admit(call); });
  // Without this a second server on the same port starts without a word and takes part of the
  // calls.
  builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, kKeepaliveTime_ms);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, kKeepaliveTimeout_ms);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_PERMIT_WITHOUT_CALLS, 1);
  builder.SetMaxReceiveMessageSize(static_cast<int>(config.limit_message_bytes + kRefusalBytes));
  builder.SetMaxSendMessageSize(-1);
  if (const Status listens = ListenAt(private_socket->address()); !listens) return listens.error();
  std::vector<int> ports(config.listen_grpc.size(), 0);
  for (std::size_t i = 0; i < ports.size(); ++i) {
    const std::string& address = config.listen_grpc[i];
    if (!IsUnixSocket(address)) {
      builder.AddListeningPort(address, CredentialsOfServer(), &ports[i]);
    } else if (const Status listens = ListenAt(address); !listens) {
      return listens.error();
    }
  }
  for (grpc::Service* service : std::initializer_list<grpc::Service*>{
           cell_service.get(), job_service.get(), machine_service.get(), program_service.get(),
           project_service.get(), handbox_service.get(), account_service.get(), host_service.get(),
           worker_service.get()}) {
    builder.RegisterService(service);
  }
  server = builder.BuildAndStart();
  for (std::size_t i = 0; i < ports.size(); ++i) {
    const std::string& address = config.listen_grpc[i];
    if (IsUnixSocket(address)) {
      grpc_addresses.push_back(address);
      continue;
    }
    if (ports[i] == 0) return PortUsed(address);  // those before it have theirs
    grpc_addresses.push_back(address.substr(0, address.rfind(':') + 1) + std::to_string(ports[i]));
  }
  if (server == nullptr) return Error{ErrorCode::kCellPortUsed, "gRPC does not start", {}};
  for (const auto& socket : sockets) socket->Serve(*server);
  return {};
}

Status Cell::Parts::ListenAt(const std::string& address) {
  auto socket = SocketListener::Make(address, gate.socket_users());
  if (!socket) return socket.error();
  sockets.push_back(*std::move(socket));
  return {};
}

Status Cell::Parts::ListenWeb() {
  if (config.listen_web.empty()) return {};
  const std::size_t colon = config.listen_web.rfind(':');
  std::string host = config.listen_web.substr(0, colon);
  if (host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
  resources = std::make_unique<WebResources>(gate, *store, *book, *programs);
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_MAX_RECEIVE_MESSAGE_LENGTH, -1);
  auto started = web::WebServer::Start(
      {.address = host,
       .port = static_cast<int>(*ParseInteger(config.listen_web.substr(colon + 1))),
       .call_bytes_max = static_cast<std::size_t>(config.limit_message_bytes),
       .upload_bytes_max = static_cast<std::size_t>(config.limit_program_bytes),
       .connections_max = static_cast<std::size_t>(config.web_connections_max),
       .origins = config.web_origins,
       .secret = gate.web_secret()},
      grpc::CreateCustomChannel(private_socket->address(), CredentialsOfChannel(), arguments),
      *resources,
      [](const web::WebLogEntry& entry) {
        spdlog::debug("{} {} {} {} bytes in {} us, {}", entry.method, entry.path, entry.http_status,
                      entry.bytes_sent, entry.duration.count(), entry.peer);
      },
      [address = config.listen_web](const std::string& why) {
        spdlog::warn("connections to {} wait: {}", address, why);
      });
  if (!started) return started.error();
  web = std::move(*started);
  return {};
}

Status Cell::Parts::StartWorkers(const std::string& join_token) {
  int count = static_cast<int>(config.workers_count);
  if (count < 0) count = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  const int paced = count > 0 ? static_cast<int>(config.workers_paced) : 0;
  auto started = WorkerProcesses::Start({.program = WorkerProgram(),
                                         .server = private_socket->address(),
                                         .join_token = join_token,
                                         .log_level = config.log_level,
                                         .log_format = config.log_format,
                                         .count = count,
                                         .pool = std::string(paced > 0 ? kComputingWorkers : ""),
                                         .further_pool = std::string(kPacedPool),
                                         .further_count = paced});
  if (!started) return started.error();
  processes = std::move(*started);
  return {};
}

// From time to time, while machines live.
std::function<void()> Cell::Parts::LookAtMachines() {
  return [this, next = std::chrono::steady_clock::time_point()]() mutable {
    hosts->Look();
    const auto now = std::chrono::steady_clock::now();
    if (now < next) return;
    next = now + kRunsLookedForAfter;
    runs->WakeAll();
  };
}

// Of virtual machines. Those that had one when a server had this store last may be alive, and come
// back by themselves. LIVE-3.01
Status Cell::Parts::StartHosts() {
  const auto leases = store->MachineLeases();
  if (!leases) return leases.error();
  const auto machines = store->ListMachines();
  if (!machines) return machines.error();
  for (const storage::MachineRecord& machine : *machines) {
    const auto lease = std::ranges::find(*leases, machine.id, &storage::MachineLease::machine);
    const bool had = lease != leases->end();
    if (had && lease->pinned) continue;
    if (!IsEnabled(machine, had || config.machines_hosts == "all")) continue;
    const Status enabled =
        host_processes->Enable(machine.id, had ? kHostsComeBack : std::chrono::milliseconds(0));
    if (enabled) continue;
    const bool full = enabled.error().code == ErrorCode::kCellResourceExhausted;
    if (had && !full) return enabled.error();
    spdlog::warn("{} does not live: {}", machine.id, bridge::ErrorText(enabled.error()));
    if (full) break;
  }
  return {};
}

Cell::Cell(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}

Result<std::unique_ptr<Cell>> Cell::Start(const Config& config) {
  std::unique_ptr<Cell> cell(new Cell(std::make_unique<Parts>(config)));
  Parts& parts = *cell->parts_;
  const std::string join_token =
      config.workers_join_token.empty() ? RandomText() : config.workers_join_token;
  // The lock of the store first: a second server on the same store must not listen for a moment.
  if (const Status opened = parts.OpenStore(); !opened) return opened.error();
  if (const Status listening = parts.Listen(join_token); !listening) return listening.error();
  if (const Status listening = parts.ListenWeb(); !listening) return listening.error();
  if (const Status started = parts.StartWorkers(join_token); !started) return started.error();
  if (const Status started = parts.StartHosts(); !started) return started.error();
  return cell;
}

Cell::~Cell() { Stop(); }

void Cell::Stop() {
  Parts& parts = *parts_;
  const auto patience = std::chrono::milliseconds(
      static_cast<std::int64_t>(parts.config.shutdown_timeout_s * 1000.0));
  const auto deadline = std::chrono::system_clock::now() + patience;
  if (parts.server != nullptr && parts.server->GetHealthCheckService() != nullptr) {
    parts.server->GetHealthCheckService()->SetServingStatus(false);
  }
  if (parts.web != nullptr) parts.web->StopAccepting();
  parts.open.StopAll();
  // Workers end when the dispatcher asks for their jobs.
  if (parts.processes != nullptr) parts.processes->StartNoMore();
  if (parts.hosts != nullptr) parts.hosts->CloseAll();
  if (parts.dispatcher != nullptr) parts.dispatcher->Drain(patience / 2);
  if (parts.processes != nullptr) parts.processes->Stop(patience / 4);
  if (parts.web != nullptr) parts.web->Stop(patience / 4);
  parts.sockets.clear();
  if (parts.server != nullptr) parts.server->Shutdown(deadline);
  // Calls are over; what they posted still runs.
  parts.web.reset();
  parts.server.reset();
  parts.private_socket.reset();
  parts.watching.reset();
  parts.compute.reset();
  parts.statuses.reset();
  parts.host_processes.reset();
  if (parts.dispatcher != nullptr) parts.dispatcher->Settle();
  if (parts.hosts != nullptr) parts.hosts->OnRunOver({});
  parts.run_products.reset();
  parts.executor.reset();
  parts.dispatcher.reset();
  parts.runs.reset();
  parts.hosts.reset();
  parts.feed.reset();
  parts.store.reset();
}

const std::vector<std::string>& Cell::grpc_addresses() const { return parts_->grpc_addresses; }

std::string Cell::web_address() const {
  if (parts_->web == nullptr) return {};
  return parts_->config.listen_web.substr(0, parts_->config.listen_web.rfind(':') + 1) +
         std::to_string(parts_->web->port());
}

}  // namespace rmlcell::server
