// Numbers of names in an object: those of its table, and none that wraps around to one of them.
#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "engine/optimo/language/byte_stream.h"
#include "engine/optimo/language/source_map.h"
#include "tests/engine/optimo/language/compile_text.h"

namespace rmlcell::optimo::object_names {
namespace {

// DECLARE AB = 7, then VR[0] = AB and VR[AB] = 5, with these numbers for the name.
std::string WithNames(std::uint64_t declared, std::uint64_t value, std::uint64_t index) {
  ByteWriter out;
  out.Raw(
      std::string("LMR\x01\x03\x01\x02"
                  "AB\0",
                  10));
  out.Byte(0x1E);
  out.Whole(declared);
  out.Raw(std::string("\x01\x07\0", 3));
  out.Raw(std::string("\x1D\x10\0\x06", 4));
  out.Whole(value);
  out.Raw("\x1D\x18");
  out.Whole(index);
  out.Raw(std::string("\x01\x05\0", 3));
  out.Fixed32(Checksum(out.bytes()));
  return out.Take();
}

// OPT-B.71: what the compiler does not write is refused.
TEST(ObjectNames, HaveTheNumbersOfTheirTable) {
  EXPECT_EQ(WithNames(0, 0, 0), MustCompile("DECLARE AB = 7\nVR[0] = AB\nVR[AB] = 5\n").object);
  EXPECT_TRUE(DecodeObject(WithNames(0, 0, 0)));
  for (const std::uint64_t wrong : {1U, 0xFFFEU, 0xFFFFU, 0x10000U, 0x10001U}) {
    EXPECT_FALSE(DecodeObject(WithNames(wrong, 0, 0))) << wrong;
    EXPECT_FALSE(DecodeObject(WithNames(0, wrong, 0))) << wrong;
    EXPECT_FALSE(DecodeObject(WithNames(0, 0, wrong))) << wrong;
  }
}

// OPT-7.41: a name of a variable whose own name comes later; OPT-1.05: and a map that is none.
TEST(ObjectNames, WhatIsWrongHasItsCode) {
  ByteWriter out;
  out.Raw(
      std::string("LMR\x01\x02\x02\x02"
                  "AB\x02"
                  "CD\0",
                  13));
  out.Raw(std::string("\x1E\0\x18\x01\x1E\x01\x01\x07\0", 9));
  out.Fixed32(Checksum(out.bytes()));
  const Result<Module> module = DecodeObject(out.Take());
  ASSERT_FALSE(module);
  EXPECT_EQ(module.error().code, ErrorCode::kObjectCorrupt);
  EXPECT_TRUE(std::string_view(module.error().detail).starts_with("OPT-E7011 "));
  const auto map = DecodeSourceMap("no map");
  ASSERT_FALSE(map);
  EXPECT_EQ(map.error().code, ErrorCode::kObjectCorrupt);
}

}  // namespace
}  // namespace rmlcell::optimo::object_names
