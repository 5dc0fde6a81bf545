#pragma once

#include <string>
#include <string_view>

// What every input of the Optimo fuzz targets must hold. Each returns what is wrong with one input;
// empty when nothing is.
namespace rmlcell::optimo {

// A program text: findings lie in the text; what compiles survives decompiling and formatting; a
// formatted text is its own format.
std::string TryText(std::string_view bytes);

// Object, executable or source map. What decodes is encoded to the same bytes, and an object's
// source compiles to the same object. Read a second time as the body of an object, with its frame
// put right, so that damage behind the checksum is reached.
std::string TryObject(std::string_view bytes);

// An even first byte converts the rest to metric, an odd one to inch: lines stay, and so does all
// that is no number.
std::string TryConvert(std::string_view bytes);

// A text for RMLCOMP: an error leaves no text; otherwise lines stay and the result has no errors of
// syntax.
std::string TryCompensate(std::string_view bytes);

}  // namespace rmlcell::optimo
