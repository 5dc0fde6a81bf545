#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "server/web/http_message.h"

// The seam between HTTP and what answers it: a Connection reads requests and writes answers, an
// Exchange answers one request. Everything but Connection::Post belongs to the connection's strand:
// called from there only, so neither side needs a lock.
namespace rmlcell::web {

class Connection {
 public:
  virtual ~Connection() = default;

  // The whole answer. The exchange is over; the connection forgets it.
  virtual void Send(HttpResponse response) = 0;

  // An answer in pieces: Begin, Writes, Finish. After Begin and after each Write the exchange waits
  // for OnTaken. Finish and Abort end the exchange; Abort shows the reader that something is
  // missing.
  virtual void Begin(HttpResponse head) = 0;
  virtual void Write(std::string bytes) = 0;
  virtual void Finish() = 0;
  virtual void Abort() = 0;

  // Asks for the next piece of a body that is not collected before; OnBody follows.
  virtual void ReadBody() = 0;

  // Runs a function on the strand. Thread-safe.
  virtual void Post(std::function<void()> work) = 0;
};

class Exchange {
 public:
  virtual ~Exchange() = default;

  virtual void Start() = 0;

  // The socket took what was written last.
  virtual void OnTaken() {}

  // A piece of the body; the last one may be empty.
  virtual void OnBody(std::string_view /*chunk*/, bool /*last*/) {}

  // Nothing was written for a while.
  virtual void OnQuiet() {}

  // A stream that ends when the client leaves. A client that only ends its sending still gets any
  // other answer.
  virtual bool IsEndless() const { return false; }

  // The client left, or the server stops: let go of everything. The connection takes nothing any
  // more.
  virtual void OnGone() = 0;
};

}  // namespace rmlcell::web
