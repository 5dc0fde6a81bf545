rmlcell_executable(material_bench SOURCES material.cc LINKS rmlcell::engine_simulation)
rmlcell_executable(material_sweep_bench SOURCES material_sweep.cc bare_sweep.cc LINKS rmlcell::engine_simulation)
rmlcell_executable(material_whole_bench SOURCES material_whole.cc bare_sweep.cc LINKS rmlcell::engine_simulation)
# A limit has all that this machine can do, ours what each machine can.
set_source_files_properties(bare_sweep.cc PROPERTIES COMPILE_OPTIONS "-march=native;-ffast-math")
