#pragma once

#include <functional>
#include <memory>

#include "server/web/connection.h"
#include "server/web/event_texts.h"
#include "server/web/request_guard.h"
#include "server/web/resource_source.h"
#include "server/web/static_page.h"
#include "server/web/web_server.h"

namespace rmlcell::web {

// What all connections share. Unchanged after the start, so it may be read from everywhere.
struct Gateway {
  WebOptions options;
  GuardRules rules;
  StaticPage page;
  std::shared_ptr<grpc::Channel> channel;
  std::shared_ptr<EventTexts> event_texts = std::make_shared<EventTexts>();
  ResourceSource* resources = nullptr;
  std::function<void(std::function<void()>)> run_blocking;   // on the threads for ResourceSource
  std::function<void(std::function<void()>)> run_computing;  // on those for Resource::make
};

// What is to be done with a request whose headers have come.
struct Plan {
  std::optional<HttpResponse> answer;  // known at once; the body is not looked at
  bool stream_body = false;            // the exchange asks for the body; otherwise it is collected
  std::size_t body_bytes_max = 0;
  // Makes the exchange once the body is there. The request lives as long as the exchange.
  std::function<std::shared_ptr<Exchange>(std::shared_ptr<Connection>, const HttpRequest&)>
      exchange;
};

// Guards, then routes: methods, resources, /healthz, the page.
Plan MakePlan(const Gateway& gateway, const HttpRequest& request);

}  // namespace rmlcell::web
