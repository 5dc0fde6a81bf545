if(TARGET rmlcell::engine_rml1)
  rmlcell_test(rml1_examples_test conformance
    SOURCES rml1_examples_test.cc rml1_decisions_test.cc rml1_example.cc rml1_facts.cc rml1_bench.cc
    LINKS rmlcell::engine_rml1)
endif()
