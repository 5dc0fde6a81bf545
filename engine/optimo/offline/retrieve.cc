#include "engine/optimo/offline/retrieve.h"

#include <utility>

#include "engine/optimo/language/compiler.h"
#include "engine/optimo/offline/listing.h"

namespace rmlcell::optimo {

Result<RetrievedProgram> RetrieveProgram(std::string_view object,
                                         const std::optional<FileNames>& inch) {
  const Result<Module> module = DecodeObject(object);
  if (!module) return module.error();
  RetrievedProgram program{.source = Decompile(*module), .list = List(*module)};
  if (inch) program.source = std::move(Convert(program.source, Direction::kToInch, inch).text);
  return program;
}

}  // namespace rmlcell::optimo
