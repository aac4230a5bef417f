# The parts that a vehicle does without, each built where its dependencies are found.

# radar_dot_part(<name> <option> [<dependency> <found> <Debian package>]...): sets RADAR_DOT_HAS_<NAME>; <found> is a
# target, or a variable that is true, where the dependency is there.
function(radar_dot_part name option)
  string(TOUPPER ${name} upper)
  set(RADAR_DOT_HAS_${upper} FALSE PARENT_SCOPE)
  set_property(CACHE ${option} PROPERTY STRINGS AUTO ON OFF)
  if(NOT ${option} STREQUAL "AUTO" AND NOT ${option})
    message(STATUS "radar_dot: ${name}: off (${option}=${${option}})")
    return()
  endif()

  set(missing "")
  set(packages "")
  set(words ${ARGN})
  while(words)
    list(POP_FRONT words dependency found package)
    if(NOT TARGET ${found} AND NOT ${found})
      list(APPEND missing ${dependency})
      list(APPEND packages ${package})
    endif()
  endwhile()
  list(JOIN missing ", " missing)
  list(JOIN packages " " packages)

  if(NOT missing)
    message(STATUS "radar_dot: ${name}: on")
    set(RADAR_DOT_HAS_${upper} TRUE PARENT_SCOPE)
  elseif(${option} STREQUAL "AUTO")
    message(STATUS "radar_dot: ${name}: off (${missing} not found)")
  else()
    message(FATAL_ERROR "radar_dot: ${option}=${${option}} needs what is not found: ${missing}. "
      "Install ${packages}, or build without the ${name}: -D${option}=OFF")
  endif()
endfunction()

find_package(Boost QUIET OPTIONAL_COMPONENTS program_options)
find_package(RapidJSON QUIET)
find_package(Embree QUIET)
find_package(TBB QUIET OPTIONAL_COMPONENTS tbbmalloc_proxy)

# PCL for PCD files: the target radar_dot_pcl. With the component io its configuration looks for VTK and Qt, for seconds,
# and has users link them; in a function its variables and messages stay here.
function(radar_dot_find_pcl)
  set(CMAKE_MESSAGE_LOG_LEVEL WARNING)
  find_package(PCL QUIET COMPONENTS common)
  find_library(PCL_IO_LIBRARY pcl_io HINTS ${PCL_LIBRARY_DIRS})
  if(PCL_FOUND AND PCL_IO_LIBRARY)
    add_library(radar_dot_pcl INTERFACE IMPORTED)
    target_include_directories(radar_dot_pcl INTERFACE ${PCL_INCLUDE_DIRS})
    target_link_libraries(radar_dot_pcl INTERFACE ${PCL_IO_LIBRARY} ${PCL_COMMON_LIBRARY})
  endif()
endfunction()
radar_dot_find_pcl()
radar_dot_part(simulation RADAR_DOT_WITH_SIMULATION
  Embree Embree_FOUND libembree-dev
  PCL radar_dot_pcl libpcl-dev
  RapidJSON RapidJSON_FOUND rapidjson-dev
  TBB.tbbmalloc_proxy TBB::tbbmalloc_proxy libtbb-dev)
radar_dot_part(tools RADAR_DOT_WITH_TOOLS
  Boost.Program_options Boost::program_options libboost-program-options-dev
  PCL radar_dot_pcl libpcl-dev
  RapidJSON RapidJSON_FOUND rapidjson-dev)
if(RADAR_DOT_HAS_TOOLS AND NOT RADAR_DOT_HAS_SIMULATION)
  message(STATUS "radar_dot: simulate_drive: off (needs the simulation)")
elseif(RADAR_DOT_HAS_SIMULATION AND NOT RADAR_DOT_HAS_TOOLS)
  message(STATUS "radar_dot: simulate_drive: off (needs the tools)")
endif()
