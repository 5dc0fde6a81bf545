# The language server; its seeds are replayed by lsp_test.
target_compile_options(rmlcell_lsp PRIVATE -fsanitize=fuzzer-no-link)
rmlcell_executable(lsp_fuzz SOURCES lsp_target.cc lsp_input.cc LINKS rmlcell::lsp)
target_compile_options(lsp_fuzz PRIVATE -fsanitize=fuzzer)
target_link_options(lsp_fuzz PRIVATE -fsanitize=fuzzer)
