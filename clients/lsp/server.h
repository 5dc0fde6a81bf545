#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "clients/lsp/check.h"
#include "clients/lsp/document.h"
#include "clients/lsp/framing.h"
#include "clients/lsp/program_folder.h"
#include "clients/lsp/protocol.h"
#include "clients/lsp/surroundings.h"

namespace rmlcell::lsp {

// A language server without its wires: bytes in, bytes out, one message at a time. It never blocks,
// has no clock and no thread; who drives it (stdio.h) decides when documents are checked.
//
// Nothing that a client sends ends it or throws: bytes that are no message, JSON that is none,
// unknown methods and wrong parameters are answered with their error, in the order of the messages.
// A request that is cancelled before its turn is answered with RequestCancelled.
class Server {
 public:
  // `folder` must outlive the server.
  explicit Server(const ProgramFolder& folder);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  void Receive(std::string_view bytes);
  // Messages that wait for their turn, and their bytes.
  bool waiting() const { return !queue_.empty(); }
  std::size_t waiting_bytes() const { return waiting_bytes_; }
  // Handles the next message. Precondition: waiting().
  void HandleNext();

  // A document changed since it was checked.
  bool unchecked() const;
  // Checks one such document and publishes what there is to say. Precondition: unchecked().
  void CheckNext();

  // What is to be sent; empties it.
  std::string TakeOutput();
  // Set when the client said "exit": 0 after "shutdown", else 1.
  std::optional<int> exit_code() const { return exit_code_; }
  // The process that started the server, as "initialize" named it; it should not be outlived.
  std::optional<std::int64_t> parent_process() const { return parent_process_; }

 private:
  struct Message;
  struct OpenDocument;
  using Answer = std::variant<Json, RequestError>;
  using RequestHandler = Answer (Server::*)(const Json& parameters);
  using NoticeHandler = void (Server::*)(const Json& parameters);
  static const std::map<std::string_view, RequestHandler>& RequestHandlers();
  static const std::map<std::string_view, NoticeHandler>& NoticeHandlers();

  void Enqueue(Frame frame);
  void Cancel(const Json& message);
  void HandleRequest(const std::string& method, const Json& id, const Json& parameters);
  void HandleNotice(const std::string& method, const Json& parameters);
  Answer Dispatch(const std::string& method, const Json& parameters);

  void Send(const Json& message);
  void Reply(const Json& id, const Answer& answer);
  void Notify(std::string_view method, Json parameters);
  void Log(std::string text);

  // server.cc: the life of the session
  Answer Initialize(const Json& parameters);
  Answer Shutdown(const Json& parameters);
  void Initialized(const Json& parameters);
  void Exit(const Json& parameters);

  // server_documents.cc
  void DidOpen(const Json& parameters);
  void DidChange(const Json& parameters);
  void DidClose(const Json& parameters);
  void DidSave(const Json& parameters);
  void Publish(const OpenDocument& open);
  OpenDocument* Find(const Json& parameters);
  OpenDocument* FindUri(std::string_view uri);
  const Findings& Checked(OpenDocument& open);
  const machine::EditedProgram* Look(OpenDocument& open);
  DocumentSurroundings Around(const OpenDocument& open);

  // server_requests.cc: one method of textDocument/ each
  struct Place;
  std::variant<Place, RequestError> ReadPlace(const Json& parameters);
  Answer OnHover(const Json& parameters);
  Answer OnDefinition(const Json& parameters);
  Answer OnReferences(const Json& parameters);
  Answer OnHighlight(const Json& parameters);
  Answer OnCompletion(const Json& parameters);
  Answer OnPrepareRename(const Json& parameters);
  Answer OnRename(const Json& parameters);
  Answer OnFormatting(const Json& parameters);
  Answer OnFolding(const Json& parameters);
  Answer OnSymbols(const Json& parameters);
  Answer OnCodeAction(const Json& parameters);

  const ProgramFolder& folder_;
  MessageReader reader_;
  std::vector<Frame> frames_;
  std::deque<std::unique_ptr<Message>> queue_;
  std::map<std::string, Message*, std::less<>> waiting_requests_;  // by their id as JSON
  std::size_t waiting_bytes_ = 0;
  std::string output_;

  enum class Phase { kNew, kRunning, kShutDown };
  Phase phase_ = Phase::kNew;
  Encoding encoding_ = Encoding::kUtf16;
  bool nested_symbols_ = false;
  bool versions_ = false;  // the client reads versions of diagnostics
  bool literal_actions_ = false;
  std::optional<std::int64_t> parent_process_;
  std::optional<int> exit_code_;
  std::map<std::string, std::unique_ptr<OpenDocument>, std::less<>> documents_;
};

}  // namespace rmlcell::lsp
