rmlcell_executable(rml1_language_bench SOURCES rml1_language.cc LINKS rmlcell::engine_rml1)
