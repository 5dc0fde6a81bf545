rmlcell_executable(material_bench SOURCES material.cc LINKS rmlcell::engine_simulation)
