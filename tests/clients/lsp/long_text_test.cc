// How long a text may be to be searched, on both sides of the bound.
#include <gtest/gtest.h>

#include <string>

#include "clients/lsp/check.h"
#include "tests/clients/lsp/editor.h"

namespace rmlcell::lsp {
namespace {

// check.h: a longer text is edited, but neither checked nor searched.
TEST(LongText, OfExactlyTheLargestSizeIsSearchedAndOneByteMoreIsNot) {
  std::string text = "DECLARE XHOME = 5\nVR[0] = XHOME\n\x1A";  // what follows costs nothing
  text.resize(kCheckedBytesMax, 'x');
  Editor editor;
  editor.Open(text);
  const Json asked = {{"textDocument", {{"uri", kUri}}}, {"position", ToJson(Position{0, 9})}};
  const Json found = editor.Result("textDocument/prepareRename", asked);
  EXPECT_EQ(found["placeholder"], "XHOME");
  EXPECT_FALSE(editor.Result("textDocument/hover", asked).is_null());
  editor.Notify(
      "textDocument/didChange",
      {{"textDocument", {{"uri", kUri}, {"version", 2}}},
       {"contentChanges", {{{"range", ToJson(Range{{1, 13}, {1, 13}})}, {"text", " "}}}}});
  const Json error = editor.Ask("textDocument/prepareRename", asked)["error"];
  EXPECT_EQ(error["code"], -32803);
  EXPECT_EQ(error["message"], "the text is too long to be searched");
  EXPECT_TRUE(editor.Result("textDocument/hover", asked).is_null());
}

}  // namespace
}  // namespace rmlcell::lsp
