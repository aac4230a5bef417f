# cmake -DSOURCE=<package> -DBUILD=<its build> -DPREFIX=<where it would be installed> -DSCRATCH=<folder>
#   -DGENERATOR=<name> -P downstream.cmake
# Installs a finished build below SCRATCH, and builds and runs a package that uses it and the example in docs/nodes.md.
cmake_minimum_required(VERSION 3.16)

macro(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE log ERROR_VARIABLE log)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${ARGN}: ${status}\n${log}")
  endif()
endmacro()

set(prefix ${SCRATCH}/root${PREFIX})
file(REMOVE_RECURSE ${SCRATCH})
run(${CMAKE_COMMAND} -E env DESTDIR=${SCRATCH}/root ${CMAKE_COMMAND} --install ${BUILD})
file(READ ${SOURCE}/docs/nodes.md text)
string(REGEX MATCH "```cpp\n([^`]*)```" block "${text}")
file(WRITE ${SCRATCH}/example.h "${CMAKE_MATCH_1}")
run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/downstream -B ${SCRATCH}/build -G ${GENERATOR}
  -DCMAKE_PREFIX_PATH=${prefix} -DEXAMPLE=${SCRATCH}/example.h)
run(${CMAKE_COMMAND} --build ${SCRATCH}/build)
# As setup.bash of the install space has it.
run(${CMAKE_COMMAND} -E env LD_LIBRARY_PATH=${prefix}/lib ${SCRATCH}/build/downstream)
set(expected "3 returns, the first at 10 m\n2 returns, the first at 15 m\n7 returns read from field 'doppler'\n")
if(NOT log STREQUAL expected)
  message(FATAL_ERROR "It says\n${log}instead of\n${expected}")
endif()
file(REMOVE_RECURSE ${SCRATCH})
