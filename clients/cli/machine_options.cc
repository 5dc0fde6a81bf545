// How a machine lives, and which computer is its host.
#include <google/protobuf/descriptor.h>
#include <google/protobuf/util/time_util.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "clients/cli/machine_call.h"
#include "clients/cli/messages.h"
#include "clients/cli/remote_machines.h"
#include "clients/cli/terminal.h"
#include "engine/core/letters.h"
#include "engine/core/number_text.h"

namespace rmlcell::cli {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Reflection;
using google::protobuf::util::TimeUtil;

// "server-lost" of server_lost.
std::string WordOf(std::string name) {
  std::ranges::replace(name, '_', '-');
  return LowerCase(name);
}

// "go-on" of SERVER_LOST_GO_ON.
std::string WordOf(const google::protobuf::EnumValueDescriptor& value) {
  const std::string& none = value.type()->FindValueByNumber(0)->name();
  const std::string prefix = none.substr(0, none.size() - std::string_view("UNSPECIFIED").size());
  return WordOf(Short(value.name(), prefix));
}

// Whether people set it here: enable and disable say the others.
bool IsSetHere(const FieldDescriptor& field) {
  return field.name() != "enabled" && field.name() != "disabled";
}

std::string TextOf(const v1::MachineOptions& options, const FieldDescriptor& field) {
  const Reflection& reflection = *v1::MachineOptions::GetReflection();
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_BOOL:
      return reflection.GetBool(options, &field) ? "on" : "off";
    case FieldDescriptor::CPPTYPE_ENUM:
      return reflection.GetEnumValue(options, &field) == 0
                 ? "-"
                 : WordOf(*reflection.GetEnum(options, &field));
    default: {
      if (!reflection.HasField(options, &field)) return "-";
      const auto& time =
          static_cast<const google::protobuf::Duration&>(reflection.GetMessage(options, &field));
      return ShortestText(static_cast<double>(TimeUtil::DurationToMilliseconds(time)) * 1e-3);
    }
  }
}

// False: it does not take this value.
bool Set(v1::MachineOptions& options, const FieldDescriptor& field, const std::string& value) {
  const Reflection& reflection = *v1::MachineOptions::GetReflection();
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_BOOL:
      if (value != "on" && value != "off") return false;
      reflection.SetBool(&options, &field, value == "on");
      return true;
    case FieldDescriptor::CPPTYPE_ENUM:
      for (int i = 1; i < field.enum_type()->value_count(); ++i) {
        const auto& one = *field.enum_type()->value(i);
        if (WordOf(one) != value) continue;
        reflection.SetEnum(&options, &field, &one);
        return true;
      }
      return false;
    default: {
      const auto seconds = ParseDouble(value);
      if (!seconds || !(*seconds >= 0.0 && *seconds <= 1e6)) return false;
      static_cast<google::protobuf::Duration&>(*reflection.MutableMessage(&options, &field)) =
          TimeUtil::MillisecondsToDuration(std::llround(*seconds * 1e3));
      return true;
    }
  }
}

std::string WordsOf(const FieldDescriptor& field) {
  if (field.cpp_type() == FieldDescriptor::CPPTYPE_BOOL) return "on, off";
  if (field.cpp_type() != FieldDescriptor::CPPTYPE_ENUM) return "seconds";
  std::string words;
  for (int i = 1; i < field.enum_type()->value_count(); ++i)
    words += (i > 1 ? ", " : "") + WordOf(*field.enum_type()->value(i));
  return words;
}

int NoOption(const std::string& text) {
  std::string known;
  const auto& fields = *v1::MachineOptions::descriptor();
  for (int i = 0; i < fields.field_count(); ++i) {
    if (IsSetHere(*fields.field(i)))
      known += "\n  " + WordOf(fields.field(i)->name()) + "=" + WordsOf(*fields.field(i));
  }
  Complain("'" + Visible(text) + "' is none; there are" + known);
  return kUsage;
}

int ShowOptions(const Remote& remote, const v1::Machine& machine) {
  if (remote.json) {
    Print(Json(machine.options()));
    return kGood;
  }
  const auto& fields = *v1::MachineOptions::descriptor();
  for (int i = 0; i < fields.field_count(); ++i) {
    if (IsSetHere(*fields.field(i)))
      Print(WordOf(fields.field(i)->name()) + "=" + TextOf(machine.options(), *fields.field(i)));
  }
  return kGood;
}

std::string NameOfThisComputer() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

}  // namespace

int MachineOptions(const Remote& remote, const MachineAct& act) {
  v1::GetMachineRequest asked;
  asked.set_name(FullName("machines", act.machine));
  v1::Machine machine;
  const grpc::Status found = Call(remote, &Service::Stub::GetMachine, asked, machine);
  if (!found.ok()) return Refused(found, remote);
  if (act.values.empty()) return ShowOptions(remote, machine);
  v1::UpdateMachineRequest request;
  request.mutable_machine()->set_name(machine.name());
  request.mutable_machine()->set_etag(machine.etag());
  request.mutable_update_mask()->add_paths("options");
  v1::MachineOptions& options = *request.mutable_machine()->mutable_options();
  options = machine.options();
  for (const std::string& text : act.values) {
    const std::size_t equals = text.find('=');
    std::string name = text.substr(0, equals);
    std::ranges::replace(name, '-', '_');
    const FieldDescriptor* field = v1::MachineOptions::descriptor()->FindFieldByName(name);
    if (equals == std::string::npos || field == nullptr || !IsSetHere(*field) ||
        !Set(options, *field, text.substr(equals + 1)))
      return NoOption(text);
  }
  v1::Machine changed;
  const grpc::Status status = Call(remote, &Service::Stub::UpdateMachine, request, changed);
  return status.ok() ? ShowOptions(remote, changed) : Refused(status, remote);
}

int TakeMachine(const Remote& remote, const MachineAct& act) {
  auto request = For<v1::TakeMachineRequest>(act);
  request.set_reason(act.reason);
  request.set_computer(act.computer.empty() ? NameOfThisComputer() : act.computer);
  v1::MachineStatus status;
  const grpc::Status taken = Call(remote, &Service::Stub::TakeMachine, request, status);
  return taken.ok() ? Show(remote, status) : Refused(taken, remote);
}

}  // namespace rmlcell::cli
