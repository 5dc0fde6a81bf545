// A program in messages: docs/api.md, "Uploading". The digest is that of FIPS 180-2, appendix B.1.
#include "server/services/program_upload.h"

#include <gtest/gtest.h>

#include <cctype>

namespace rmlcell::server {
namespace {

constexpr char kAbc[] = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";

v1::UploadProgramRequest Header(std::int64_t size, const std::string& sha256 = kAbc) {
  v1::UploadProgramRequest message;
  message.mutable_header()->set_file_name("part.S");
  message.mutable_header()->set_size(size);
  message.mutable_header()->set_sha256(sha256);
  return message;
}

v1::UploadProgramRequest Chunk(const std::string& bytes) {
  v1::UploadProgramRequest message;
  message.set_chunk(bytes);
  return message;
}

// At most ten bytes.
ProgramUpload Small() {
  return ProgramUpload([](std::int64_t bytes) {
    return bytes <= 10 ? Status() : Error{ErrorCode::kCellTooLarge, "more than 10", {}};
  });
}

void ExpectRefused(const Status& status, ErrorCode code, const std::string& detail) {
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, code);
  EXPECT_EQ(status.error().detail, detail);
}

TEST(ProgramUpload, TheBytesOfAllChunksAreTheProgram) {
  ProgramUpload upload = Small();
  ASSERT_TRUE(upload.Add(Header(3)).ok());
  for (const char* chunk : {"a", "", "bc"}) ASSERT_TRUE(upload.Add(Chunk(chunk)).ok());
  ASSERT_TRUE(upload.End().ok());
  EXPECT_EQ(upload.header().file_name(), "part.S");
  EXPECT_EQ(upload.TakeBytes(), "abc");
}

TEST(ProgramUpload, ADigestMayBeInCapitals) {
  std::string capitals = kAbc;
  for (char& c : capitals) c = static_cast<char>(std::toupper(c));
  ProgramUpload upload = Small();
  ASSERT_TRUE(upload.Add(Header(3, capitals)).ok());
  EXPECT_EQ(upload.header().sha256(), kAbc);
  ASSERT_TRUE(upload.Add(Chunk("abc")).ok());
  EXPECT_TRUE(upload.End().ok());
}

TEST(ProgramUpload, AHeaderThatSaysTooLittleIsRefusedBeforeTheFirstByte) {
  const ErrorCode invalid = ErrorCode::kCellInvalidArgument;
  ExpectRefused(Small().Add(Header(-1)), invalid, "header.size is -1");
  ExpectRefused(Small().Add(Header(3, "")), invalid, "header.sha256 is missing");
  ExpectRefused(Small().Add(Header(3, "abc")), invalid,
                "header.sha256 is not 64 hexadecimal digits");
  ExpectRefused(Small().Add(Header(11)), ErrorCode::kCellTooLarge, "more than 10");
  EXPECT_TRUE(Small().Add(Header(10)).ok());
}

TEST(ProgramUpload, TheHeaderComesFirstAndOnce) {
  ExpectRefused(Small().Add(Chunk("abc")), ErrorCode::kCellInvalidArgument,
                "the first message must be the header");
  // A message with neither is no header.
  ExpectRefused(Small().Add({}), ErrorCode::kCellInvalidArgument,
                "the first message must be the header");
  ExpectRefused(Small().End(), ErrorCode::kCellInvalidArgument, "no header");
  ProgramUpload upload = Small();
  ASSERT_TRUE(upload.Add(Header(3)).ok());
  ExpectRefused(upload.Add(Header(3)), ErrorCode::kCellInvalidArgument, "a second header");
}

TEST(ProgramUpload, OneByteMoreThanAnnouncedIsRefusedAtOnceOneLessAtTheEnd) {
  ProgramUpload more = Small();
  ASSERT_TRUE(more.Add(Header(3)).ok());
  ASSERT_TRUE(more.Add(Chunk("ab")).ok());
  ExpectRefused(more.Add(Chunk("cd")), ErrorCode::kCellChecksum, "more bytes than the header says");
  ProgramUpload less = Small();
  ASSERT_TRUE(less.Add(Header(3)).ok());
  ASSERT_TRUE(less.Add(Chunk("ab")).ok());
  ExpectRefused(less.End(), ErrorCode::kCellChecksum, "2 bytes came, 3 were announced");
}

TEST(ProgramUpload, OtherBytesOfTheSameNumberAreRefused) {
  ProgramUpload upload = Small();
  ASSERT_TRUE(upload.Add(Header(3)).ok());
  ASSERT_TRUE(upload.Add(Chunk("abd")).ok());
  ExpectRefused(upload.End(), ErrorCode::kCellChecksum, "SHA-256 differs");
}

TEST(ProgramUpload, AnEmptyProgramIsNone) {
  ProgramUpload announced = Small();
  ASSERT_TRUE(announced.Add(Header(0)).ok());
  ExpectRefused(announced.End(), ErrorCode::kCellEmptyProgram, "part.S");
  ProgramUpload forgotten = Small();
  ASSERT_TRUE(forgotten.Add(Header(0)).ok());
  ExpectRefused(forgotten.Add(Chunk("a")), ErrorCode::kCellInvalidArgument,
                "header.size is missing: give the number of bytes that follow");
}

TEST(ProgramUpload, OneByteIsAProgram) {
  ProgramUpload upload = Small();
  ASSERT_TRUE(
      upload.Add(Header(1, "ca978112ca1bbdcafac231b39a23dc4da786eff8147c4e72b9807785afee48bb"))
          .ok());
  ASSERT_TRUE(upload.Add(Chunk("a")).ok());
  EXPECT_TRUE(upload.End().ok());
  EXPECT_EQ(upload.TakeBytes(), "a");
}

}  // namespace
}  // namespace rmlcell::server
