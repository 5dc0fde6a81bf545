#pragma once

#include <grpcpp/grpcpp.h>

#include <string>

#include "server/services/open_stream.h"

// Methods of the contract that come in a later version: each passes the gate and says
// UNIMPLEMENTED. They stand in tests/conformance/later_methods.csv, too.
namespace rmlcell::server {

// Status of such a call: the gate's refusal, or that there is no such method yet.
grpc::Status LaterStatus(const CallNeeds& needs, const grpc::ServerContextBase& context,
                         std::string_view method,
                         const google::protobuf::Message* request = nullptr);

inline grpc::ServerUnaryReactor* Later(const CallNeeds& needs, grpc::CallbackServerContext* context,
                                       const google::protobuf::Message& request,
                                       std::string_view method) {
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  reactor->Finish(LaterStatus(needs, *context, method, &request));
  return reactor;
}

// For the body of a service: `service` is its name in the contract.
#define RMLCELL_LATER(service, method, Response)                                             \
  grpc::ServerUnaryReactor* method(grpc::CallbackServerContext* context,                     \
                                   const v1::method##Request* request, Response*) override { \
    return Later(needs_, context, *request, service "/" #method);                            \
  }
#define RMLCELL_LATER_READ(service, method)                                                \
  grpc::ServerWriteReactor<v1::method##Response>* method(                                  \
      grpc::CallbackServerContext* context, const v1::method##Request* request) override { \
    return new EndedStream<grpc::ServerWriteReactor<v1::method##Response>>(                \
        LaterStatus(needs_, *context, service "/" #method, request));                      \
  }
#define RMLCELL_LATER_WRITE(service, method, Response)                                       \
  grpc::ServerReadReactor<v1::method##Request>* method(grpc::CallbackServerContext* context, \
                                                       Response*) override {                 \
    return new EndedStream<grpc::ServerReadReactor<v1::method##Request>>(                    \
        LaterStatus(needs_, *context, service "/" #method));                                 \
  }
#define RMLCELL_LATER_BOTH(service, method)                                                     \
  grpc::ServerBidiReactor<v1::method##Request, v1::method##Response>* method(                   \
      grpc::CallbackServerContext* context) override {                                          \
    return new EndedStream<grpc::ServerBidiReactor<v1::method##Request, v1::method##Response>>( \
        LaterStatus(needs_, *context, service "/" #method));                                    \
  }

}  // namespace rmlcell::server
