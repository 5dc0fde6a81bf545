// The fake cell on a port of its own, for tests in other languages and for looking at the page:
// web_fake_cell [port] [web-dir]. Prints its URL and ends when standard input does.
#include <cstdlib>
#include <iostream>
#include <string>

#include "tests/server/web/fake_cell.h"

int main(int argc, char** argv) {
  rmlcell::web::WebOptions options;
  options.port = argc > 1 ? std::atoi(argv[1]) : 0;
  if (argc > 2) options.web_dir = argv[2];
  rmlcell::web::testing::FakeCell cell(options);
  std::cout << "http://127.0.0.1:" << cell.port() << std::endl;
  std::string line;
  while (std::getline(std::cin, line)) {
    if (line == "stop") cell.StopStreams();
  }
}
