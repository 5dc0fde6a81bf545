#pragma once

#include <grpcpp/grpcpp.h>

#include <chrono>
#include <memory>
#include <string>

#include "clients/cli/remote.h"
#include "rmlcell/v1/common.pb.h"

namespace rmlcell::cli {

std::shared_ptr<grpc::Channel> Connect(const Remote& remote);

// A context with a deadline: unary calls never hang.
inline constexpr std::chrono::seconds kUnaryDeadline{60};
void Prepare(grpc::ClientContext& context, std::chrono::seconds patience = kUnaryDeadline);

// Prints what the server said, findings included. Returns the exit code that fits.
int Refused(const grpc::Status& status, const Remote& remote);

// What there is to say about a program, and what will come of it.
void PrintProgramFindings(const v1::Findings& findings);

// "17" or "jobs/17" -> "jobs/17"; the same for machines and projects.
std::string FullName(const std::string& collection, const std::string& name);

}  // namespace rmlcell::cli
