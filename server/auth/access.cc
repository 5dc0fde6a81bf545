#include "server/auth/access.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>

namespace rmlcell::server {
namespace {

v1::Access Asks(v1::Permission permission) {
  v1::Access access;
  access.set_permission(permission);
  return access;
}

}  // namespace

Permissions ViewerPermissions() { return {v1::PERMISSION_VIEW}; }

Permissions ProgrammerPermissions() {
  return {v1::PERMISSION_VIEW, v1::PERMISSION_STOP, v1::PERMISSION_PROGRAM};
}

Permissions OperatorPermissions() {
  return {v1::PERMISSION_VIEW, v1::PERMISSION_STOP, v1::PERMISSION_OPERATE};
}

Permissions AdministratorPermissions() {
  return {v1::PERMISSION_VIEW, v1::PERMISSION_STOP, v1::PERMISSION_PROGRAM, v1::PERMISSION_OPERATE,
          v1::PERMISSION_ADMINISTER};
}

AccessTable::AccessTable() {
  // Whether a server lives may be asked by whoever reaches it; what it offers, by who may look.
  for (const char* method : {"/grpc.health.v1.Health/Check", "/grpc.health.v1.Health/Watch"})
    rows_.emplace(method, Asks(v1::PERMISSION_NONE));
  // Clients try the newer name first, and take the older one when they hear that there is none.
  for (const char* version : {"v1alpha", "v1"}) {
    rows_.emplace(
        "/grpc.reflection." + std::string(version) + ".ServerReflection/ServerReflectionInfo",
        Asks(v1::PERMISSION_VIEW));
  }
  const google::protobuf::DescriptorPool& pool =
      *google::protobuf::DescriptorPool::generated_pool();
  for (const char* name :
       {"account", "cell", "handbox", "host", "job", "machine", "program", "project", "worker"}) {
    const auto* file = pool.FindFileByName("rmlcell/v1/" + std::string(name) + ".proto");
    for (int i = 0; file != nullptr && i < file->service_count(); ++i) {
      const google::protobuf::ServiceDescriptor& service = *file->service(i);
      for (int j = 0; j < service.method_count(); ++j) {
        const google::protobuf::MethodDescriptor& method = *service.method(j);
        if (!method.options().HasExtension(v1::access)) continue;
        rows_.emplace("/" + service.full_name() + "/" + method.name(),
                      method.options().GetExtension(v1::access));
      }
    }
  }
}

const v1::Access* AccessTable::Find(std::string_view method) const {
  const auto row = rows_.find(method);
  return row == rows_.end() || row->second.permission() == v1::PERMISSION_UNSPECIFIED
             ? nullptr
             : &row->second;
}

std::string ResourceOf(const google::protobuf::Message& request, std::string_view path) {
  const std::size_t dot = path.find('.');
  const google::protobuf::FieldDescriptor* field =
      request.GetDescriptor()->FindFieldByName(std::string(path.substr(0, dot)));
  if (field == nullptr || field->is_repeated()) return {};
  const google::protobuf::Reflection& reflection = *request.GetReflection();
  if (dot == std::string_view::npos) {
    return field->type() == google::protobuf::FieldDescriptor::TYPE_STRING
               ? reflection.GetString(request, field)
               : std::string();
  }
  if (field->type() != google::protobuf::FieldDescriptor::TYPE_MESSAGE) return {};
  return ResourceOf(reflection.GetMessage(request, field), path.substr(dot + 1));
}

}  // namespace rmlcell::server
