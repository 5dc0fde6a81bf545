#pragma once

#include <google/protobuf/field_mask.pb.h>
#include <google/protobuf/message.h>

#include <set>
#include <span>
#include <string>
#include <string_view>

#include "engine/core/result.h"

namespace rmlcell::server {

// Which fields of `wanted` an update takes over (AIP-134): those that the mask names; "*": all of
// `fields`; without a mask those that `wanted` has a value for, so that a client that knows one
// field changes one. Only the mask can empty a field: a value that is empty is as good as none on
// the wire. Precondition: `wanted` has every one of `fields`. Error: CellInvalidArgument for a path
// that is none of `fields`.
Result<std::set<std::string, std::less<>>> FieldsToUpdate(const google::protobuf::FieldMask& mask,
                                                          const google::protobuf::Message& wanted,
                                                          std::span<const std::string_view> fields);

}  // namespace rmlcell::server
