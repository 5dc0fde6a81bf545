#pragma once

#include <initializer_list>
#include <map>
#include <string>
#include <string_view>

#include "rmlcell/v1/access.pb.h"

namespace google::protobuf {
class Message;
}

namespace rmlcell::server {

// What a caller may do: a set, in which no permission holds another one (live.md 4.04).
class Permissions {
 public:
  Permissions() = default;
  Permissions(std::initializer_list<v1::Permission> permissions) {
    for (const v1::Permission one : permissions) bits_ |= Bit(one);
  }
  bool Has(v1::Permission permission) const { return (bits_ & Bit(permission)) != 0; }
  bool operator==(const Permissions&) const = default;

 private:
  static unsigned Bit(v1::Permission permission) { return 1U << static_cast<unsigned>(permission); }
  unsigned bits_ = 0;
};

Permissions ViewerPermissions();
Permissions ProgrammerPermissions();
Permissions OperatorPermissions();
Permissions AdministratorPermissions();

// What every method asks for, as the contract states it (proto/rmlcell/v1/access.proto), and gRPC's
// own methods.
class AccessTable {
 public:
  AccessTable();
  // "/rmlcell.v1.JobService/SubmitJob"; null: nothing is stated, so nobody may call it.
  const v1::Access* Find(std::string_view method) const;

 private:
  std::map<std::string, v1::Access, std::less<>> rows_;
};

// The value of the field that `path` names ("job.machine"); empty where it has none.
std::string ResourceOf(const google::protobuf::Message& request, std::string_view path);

}  // namespace rmlcell::server
