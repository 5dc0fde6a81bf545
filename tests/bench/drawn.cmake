rmlcell_executable(drawn_count SOURCES drawn_count.cc planner_calls.cc
  LINKS rmlcell::engine_simulation rmlcell::engine_families rmlcell::engine_optimo_language rmlcell::engine_rml1)
# Three methods of motion::Planner, which planner_calls.cc stands before.
target_link_options(drawn_count PRIVATE
  LINKER:--wrap=_ZN7rmlcell6motion7Planner6AppendERKNS0_11MoveCommandE
  LINKER:--wrap=_ZN7rmlcell6motion7Planner4MarkEm
  LINKER:--wrap=_ZN7rmlcell6motion7Planner4StopEv)
