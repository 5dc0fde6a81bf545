// What an editor is offered: all of it, or a part that says so.
#include <gtest/gtest.h>

#include <string>

#include "server/base/config.h"
#include "server/programs/language_tools.h"
#include "tests/server/server_bed.h"

namespace rmlcell::server {
namespace {

// Where there is more than a list has room for, typing on finds the rest.
TEST(ListsThatAreCut, SayThatTheyAre) {
  ServerBed bed;
  Config config;
  ProgramBook programs{bed.store(), config};
  LanguageTools tools{bed.store(), programs};
  const auto offered = [&tools](int labels) {
    std::string text;
    for (int label = 1; label <= labels; ++label) text += std::to_string(label) + " DELAY 1.0\n";
    text += "GOTO ";
    v1::CompleteRequest request;
    request.mutable_text()->mutable_program()->set_file_name("45.S");
    request.mutable_text()->mutable_program()->set_content(text);
    request.mutable_text()->set_machine("machines/optimo-1");
    request.mutable_position()->set_line(labels + 1);
    request.mutable_position()->set_column(6);
    return Must(tools.Complete(request));
  };
  const v1::CompleteResponse all = offered(3);
  EXPECT_FALSE(all.cut());
  EXPECT_EQ(all.completions_size(), 3);
  EXPECT_TRUE(offered(1'500).cut());
}

}  // namespace
}  // namespace rmlcell::server
