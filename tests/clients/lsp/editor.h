#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "clients/lsp/server.h"

// An editor in the process of the test, with a folder of its own.
namespace rmlcell::lsp {

// Files by their URI; nothing of the disk.
class FakeFolder final : public ProgramFolder {
 public:
  std::vector<machine::NumberedFile> Programs(std::string_view uri,
                                              SourceExtensions extensions) const override;
  Result<std::string> Read(std::string_view uri) const override;

  std::map<std::string, std::string, std::less<>> files;
};

// A text with its cursor, written as one '|'.
struct WithCursor {
  std::string text;
  std::size_t offset = 0;
};
WithCursor Cursor(std::string_view marked);

inline constexpr const char* kUri = "file:///work/12.S";

class Editor {
 public:
  // Sends initialize with these capabilities, and initialized.
  explicit Editor(Json capabilities = DefaultCapabilities());
  static Json DefaultCapabilities();

  void Send(const Json& message);
  void SendBytes(std::string_view bytes) { server.Receive(bytes); }
  void Notify(std::string_view method, Json parameters);
  // The whole answer: with "result" or "error".
  Json Ask(std::string_view method, Json parameters);
  // The result; the test fails when it is an error.
  Json Result(std::string_view method, Json parameters);

  void Open(std::string_view text, std::string_view uri = kUri,
            std::string_view language = "optimo-rml");
  // Asks at the cursor of a text, which is opened.
  Json At(std::string_view method, std::string_view marked, Json more = Json::object());

  // Handles all that waits; returns what came back.
  std::vector<Json> Handle();
  // Checks all documents; the diagnostics of the last one.
  Json Diagnostics();

  FakeFolder folder;
  Server server{folder};
  std::vector<Json> notices;  // all so far
  Json capabilities;          // of the server

 private:
  int next_id_ = 0;
};

// A text after the edits of one document, as an editor applies them.
std::string Applied(std::string text, const Json& edits, Encoding encoding = Encoding::kUtf16);

}  // namespace rmlcell::lsp
