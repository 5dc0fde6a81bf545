// A name that is none is told with the form that it should have.
#include <gtest/gtest.h>

#include "server/base/names.h"

namespace rmlcell::server {
namespace {

template <class T>
std::string WhyNoName(const Result<T>& parsed) {
  return parsed ? std::string() : std::string(parsed.error().detail);
}

TEST(ToldNames, EachFormIsTold) {
  for (const char* name : {"lid", "projects/", "projects/Lid"})
    EXPECT_EQ(WhyNoName(ParseProjectName(name)),
              "name is '" + std::string(name) + "', expected is projects/ID");
  for (const char* name : {"mill-1", "machines/", "machines/Mill"})
    EXPECT_EQ(WhyNoName(ParseMachineName(name)),
              "name is '" + std::string(name) + "', expected is machines/ID");
  for (const char* name : {"7", "jobs/", "jobs/0", "jobs/x"})
    EXPECT_EQ(WhyNoName(ParseJobName(name)),
              "name is '" + std::string(name) + "', expected is jobs/NUMBER");
  for (const char* name :
       {"machines", "machines/a", "machines/a/programs/x", "machines/A/programs/1"})
    EXPECT_EQ(WhyNoName(ParseProgramName(name)),
              "name is '" + std::string(name) + "', expected is machines/ID/programs/NUMBER");
}

}  // namespace
}  // namespace rmlcell::server
