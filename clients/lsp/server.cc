#include "clients/lsp/server.h"

#include <exception>
#include <nlohmann/json.hpp>
#include <utility>

#include "clients/lsp/open_document.h"

namespace rmlcell::lsp {
namespace {

constexpr int kLogError = 1;  // of LSP
constexpr int kSyncIncremental = 2;

const Json& Nothing() {
  static const Json nothing = nullptr;
  return nothing;
}

// The first encoding of the client's list that is known here; UTF-16 without one.
Encoding ChooseEncoding(const Json& parameters) {
  const Json* offered = Member(parameters, {"capabilities", "general", "positionEncodings"});
  if (offered == nullptr || !offered->is_array()) return Encoding::kUtf16;
  for (const Json& one : *offered) {
    if (one == "utf-8") return Encoding::kUtf8;
    if (one == "utf-16") return Encoding::kUtf16;
    if (one == "utf-32") return Encoding::kUtf32;
  }
  return Encoding::kUtf16;
}

std::string_view NameOf(Encoding encoding) {
  switch (encoding) {
    case Encoding::kUtf8:
      return "utf-8";
    case Encoding::kUtf32:
      return "utf-32";
    case Encoding::kUtf16:
      break;
  }
  return "utf-16";
}

Json Capabilities(Encoding encoding) {
  return {{"positionEncoding", NameOf(encoding)},
          {"textDocumentSync",
           {{"openClose", true}, {"change", kSyncIncremental}, {"save", {{"includeText", false}}}}},
          {"hoverProvider", true},
          {"definitionProvider", true},
          {"referencesProvider", true},
          {"documentHighlightProvider", true},
          {"documentSymbolProvider", true},
          {"foldingRangeProvider", true},
          {"documentFormattingProvider", true},
          {"completionProvider", {{"triggerCharacters", {"/", "[", "$"}}}},
          {"renameProvider", {{"prepareProvider", true}}},
          {"codeActionProvider", {{"codeActionKinds", {"quickfix", "source.fixAll.rmlcell"}}}}};
}

}  // namespace

Server::Server(const ProgramFolder& folder) : folder_(folder) {}
Server::~Server() = default;

void Server::Receive(std::string_view bytes) {
  reader_.Feed(bytes, frames_);
  for (Frame& frame : frames_) Enqueue(std::move(frame));
  frames_.clear();
}

void Server::Enqueue(Frame frame) {
  auto message = std::make_unique<Message>();
  message->bytes = frame.body.size();
  if (!frame.problem.empty()) {
    message->problem = std::move(frame.problem);
  } else if (std::optional<Json> json = ReadJson(frame.body)) {
    message->json = *std::move(json);
    const Json* method = Member(message->json, {"method"});
    const Json* id = Member(message->json, {"id"});
    if (method != nullptr && *method == "$/cancelRequest" && id == nullptr)
      return Cancel(message->json);
    if (method != nullptr && id != nullptr) waiting_requests_[WriteJson(*id)] = message.get();
  } else {
    message->problem = "the message is no JSON, or nested too deep";
  }
  waiting_bytes_ += message->bytes;
  queue_.push_back(std::move(message));
}

// Acts at once: the request still waits, or it is answered already.
void Server::Cancel(const Json& message) {
  const Json* id = Member(message, {"params", "id"});
  if (id == nullptr) return;
  const auto waiting = waiting_requests_.find(WriteJson(*id));
  if (waiting != waiting_requests_.end()) waiting->second->cancelled = true;
}

void Server::HandleNext() {
  const std::unique_ptr<Message> message = std::move(queue_.front());
  queue_.pop_front();
  waiting_bytes_ -= message->bytes;
  if (!message->problem.empty())
    return Reply(nullptr, RequestError{message->problem_number, message->problem});
  const Json& json = message->json;
  const Json* id = Member(json, {"id"});
  if (id != nullptr) {
    const auto waiting = waiting_requests_.find(WriteJson(*id));
    if (waiting != waiting_requests_.end() && waiting->second == message.get())
      waiting_requests_.erase(waiting);
  }
  const std::optional<std::string> method = TextMember(json, {"method"});
  const bool answer = json.is_object() && !method && id != nullptr &&
                      (json.contains("result") || json.contains("error"));
  if (answer) return;  // this server asks nothing
  const bool good_id = id == nullptr || id->is_string() || id->is_number_integer();
  if (!method || !good_id) {
    return Reply(good_id && id != nullptr ? *id : Nothing(),
                 RequestError{ErrorNumber::kInvalidRequest, "this is no request"});
  }
  const Json* found = Member(json, {"params"});
  const Json& parameters = found == nullptr ? Nothing() : *found;
  if (id == nullptr) return HandleNotice(*method, parameters);
  if (message->cancelled)
    return Reply(*id, RequestError{ErrorNumber::kRequestCancelled, "cancelled"});
  HandleRequest(*method, *id, parameters);
}

void Server::HandleRequest(const std::string& method, const Json& id, const Json& parameters) {
  Reply(id, Dispatch(method, parameters));
}

// The outermost frame of a request: what is thrown below fails it alone.
Server::Answer Server::Dispatch(const std::string& method, const Json& parameters) {
  if (phase_ == Phase::kShutDown)
    return RequestError{ErrorNumber::kInvalidRequest, "the server is shut down"};
  if (phase_ == Phase::kNew && method != "initialize")
    return RequestError{ErrorNumber::kServerNotInitialized, "initialize comes first"};
  const auto handler = RequestHandlers().find(method);
  if (handler == RequestHandlers().end())
    return RequestError{ErrorNumber::kMethodNotFound, "there is no method " + method};
  try {
    return (this->*handler->second)(parameters);
  } catch (const std::exception& error) {
    return RequestError{ErrorNumber::kInternalError, error.what()};
  }
}

void Server::HandleNotice(const std::string& method, const Json& parameters) {
  if (method == "exit") return Exit(parameters);
  if (phase_ != Phase::kRunning) return;
  const auto handler = NoticeHandlers().find(method);
  if (handler == NoticeHandlers().end()) return;  // of optional ones, or unknown: no answer
  try {
    (this->*handler->second)(parameters);
  } catch (const std::exception& error) {
    Log(method + ": " + error.what());
  }
}

Server::Answer Server::Initialize(const Json& parameters) {
  if (phase_ != Phase::kNew)
    return RequestError{ErrorNumber::kInvalidRequest, "initialize came before"};
  phase_ = Phase::kRunning;
  encoding_ = ChooseEncoding(parameters);
  nested_symbols_ = FlagMember(parameters, {"capabilities", "textDocument", "documentSymbol",
                                            "hierarchicalDocumentSymbolSupport"});
  versions_ = FlagMember(parameters,
                         {"capabilities", "textDocument", "publishDiagnostics", "versionSupport"});
  literal_actions_ = Member(parameters, {"capabilities", "textDocument", "codeAction",
                                         "codeActionLiteralSupport"}) != nullptr;
  parent_process_ = NumberMember(parameters, {"processId"});
  return Json{{"capabilities", Capabilities(encoding_)}, {"serverInfo", {{"name", "rmlcell"}}}};
}

Server::Answer Server::Shutdown(const Json&) {
  phase_ = Phase::kShutDown;
  return Json(nullptr);
}

void Server::Initialized(const Json&) {}

void Server::Exit(const Json&) { exit_code_ = phase_ == Phase::kShutDown ? 0 : 1; }

void Server::Send(const Json& message) { output_ += Framed(WriteJson(message)); }

void Server::Reply(const Json& id, const Answer& answer) {
  Json message = {{"jsonrpc", "2.0"}, {"id", id}};
  if (const auto* error = std::get_if<RequestError>(&answer)) {
    message["error"] = {{"code", static_cast<int>(error->number)}, {"message", error->message}};
  } else {
    message["result"] = std::get<Json>(answer);
  }
  Send(message);
}

void Server::Notify(std::string_view method, Json parameters) {
  Send({{"jsonrpc", "2.0"}, {"method", method}, {"params", std::move(parameters)}});
}

void Server::Log(std::string text) {
  Notify("window/logMessage", {{"type", kLogError}, {"message", std::move(text)}});
}

std::string Server::TakeOutput() { return std::exchange(output_, {}); }

const std::map<std::string_view, Server::RequestHandler>& Server::RequestHandlers() {
  static const std::map<std::string_view, RequestHandler> handlers = {
      {"initialize", &Server::Initialize},
      {"shutdown", &Server::Shutdown},
      {"textDocument/hover", &Server::OnHover},
      {"textDocument/definition", &Server::OnDefinition},
      {"textDocument/references", &Server::OnReferences},
      {"textDocument/documentHighlight", &Server::OnHighlight},
      {"textDocument/completion", &Server::OnCompletion},
      {"textDocument/prepareRename", &Server::OnPrepareRename},
      {"textDocument/rename", &Server::OnRename},
      {"textDocument/formatting", &Server::OnFormatting},
      {"textDocument/foldingRange", &Server::OnFolding},
      {"textDocument/documentSymbol", &Server::OnSymbols},
      {"textDocument/codeAction", &Server::OnCodeAction},
  };
  return handlers;
}

const std::map<std::string_view, Server::NoticeHandler>& Server::NoticeHandlers() {
  static const std::map<std::string_view, NoticeHandler> handlers = {
      {"initialized", &Server::Initialized},          {"textDocument/didOpen", &Server::DidOpen},
      {"textDocument/didChange", &Server::DidChange}, {"textDocument/didClose", &Server::DidClose},
      {"textDocument/didSave", &Server::DidSave},
  };
  return handlers;
}

}  // namespace rmlcell::lsp
