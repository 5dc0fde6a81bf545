# Compiler, linker and warning settings that hold for every target.
find_program(CCACHE ccache)
if(CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # Tests are compiled alike for every preset: seen from their build folders their paths are the same,
  # and so the sanitizer build takes them from the cache.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_BASEDIR=${CMAKE_SOURCE_DIR} ${CCACHE})
endif()
find_program(LLD ld.lld)
if(LLD)
  add_link_options(-fuse-ld=lld)
endif()
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()

find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED)  # by every preset: the engine's geometry

# Same bytes on every machine: no contraction, no reassociation (docs/ARCHITECTURE.md, determinism).
add_compile_options(-ffp-contract=off)

add_library(rmlcell_warnings INTERFACE)
target_compile_options(rmlcell_warnings INTERFACE
  -Wall -Wextra -Wconversion -Wshadow -Wnon-virtual-dtor -Wold-style-cast -Werror
  # Designated initialisers leave members at their defaults on purpose.
  -Wno-missing-field-initializers)

# g++ 12 sees overlaps in std::string and unset values in std::optional that are not there (GCC 105651,
# 80635): both warnings are wrong more often than right at -O3.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  target_compile_options(rmlcell_warnings INTERFACE -Wno-restrict -Wno-maybe-uninitialized)
endif()

# Of clang++ -Wconversion is about signs, too; Eigen counts with signed numbers, arrays do not.
if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  target_compile_options(rmlcell_warnings INTERFACE -Wno-sign-conversion)
endif()

# Sources compiled several at a time are included by one that is made: g++ takes them for headers, whose
# classes should not have members of unnamed namespaces.
if((CMAKE_UNITY_BUILD OR RMLCELL_TESTS_AS_RELEASED) AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  target_compile_options(rmlcell_warnings INTERFACE -Wno-subobject-linkage)
endif()

set(RMLCELL_SANITIZE "" CACHE STRING "Sanitizers, as -fsanitize= takes them: address,undefined or thread")
if(RMLCELL_SANITIZE)
  # With -O2 and full debug information a sanitized file takes five times as long to compile as without.
  set(CMAKE_CXX_FLAGS_RELWITHDEBINFO "-O1 -g1")
  # The assertions see an index past the end of a view, which is nobody's memory.
  add_compile_options(-fsanitize=${RMLCELL_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all
                      -D_GLIBCXX_ASSERTIONS)
  # The race detector does not know the fences of Asio. They stand beside its locks, which it does know.
  if(RMLCELL_SANITIZE STREQUAL "thread")
    add_compile_definitions(BOOST_ASIO_DISABLE_FENCED_BLOCK)
  endif()
  add_link_options(-fsanitize=${RMLCELL_SANITIZE})
endif()
