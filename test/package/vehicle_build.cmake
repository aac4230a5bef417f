# cmake -DSOURCE=<package> -DSCRATCH=<folder> -DGENERATOR=<name> -P vehicle_build.cmake
# Configures the package as on a vehicle that has catkin, Eigen, OpenCV, fmt, libjpeg, TBB and yaml-cpp only.
cmake_minimum_required(VERSION 3.16)

set(absent Embree PCL RapidJSON boost_program_options Torch)
set(without "")
foreach(package ${absent})
  list(APPEND without -DCMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
endforeach()

# Sets status and log.
macro(configure folder)
  file(REMOVE_RECURSE ${SCRATCH}/${folder})
  execute_process(COMMAND ${CMAKE_COMMAND} -S ${SOURCE} -B ${SCRATCH}/${folder} -G ${GENERATOR} ${without} ${ARGN}
    RESULT_VARIABLE status OUTPUT_VARIABLE log ERROR_VARIABLE log)
  string(REGEX REPLACE "[ \n]+" " " log "${log}")  # CMake wraps its messages
endmacro()

function(expect text)
  string(FIND "${log}" "${text}" place)
  if(place EQUAL -1)
    message(FATAL_ERROR "The configure log lacks '${text}':\n${log}")
  endif()
endfunction()

# Runs a command in the folder vehicle and checks the words of its output.
function(expect_listed)
  cmake_parse_arguments(ARG "" "" "COMMAND;WITH;WITHOUT" ${ARGN})
  execute_process(COMMAND ${ARG_COMMAND} WORKING_DIRECTORY ${SCRATCH}/vehicle
    RESULT_VARIABLE failed OUTPUT_VARIABLE list ERROR_VARIABLE list)
  if(failed)
    message(FATAL_ERROR "${ARG_COMMAND}: ${failed}\n${list}")
  endif()
  foreach(word ${ARG_WITH})
    if(NOT list MATCHES "[^a-z]${word}[^a-z_]")
      message(FATAL_ERROR "${ARG_COMMAND} does not list ${word}:\n${list}")
    endif()
  endforeach()
  foreach(word ${ARG_WITHOUT})
    if(list MATCHES "[^a-z]${word}[^a-z_]")
      message(FATAL_ERROR "${ARG_COMMAND} lists ${word}, which a vehicle does not need:\n${list}")
    endif()
  endforeach()
endfunction()

configure(vehicle)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "The package does not configure without ${absent}:\n${log}")
endif()
expect("radar_dot: simulation: off (Embree, PCL, RapidJSON not found)")
expect("radar_dot: tools: off (Boost.Program_options, PCL, RapidJSON not found)")
expect_listed(COMMAND ${CMAKE_COMMAND} --build . --target help
  WITH radar_dot_radar radar_dot_vision radar_dot_objects radar_dot_nodelets stamp_guard_test
  WITHOUT radar_dot_dataset radar_dot_simulation radar_dot_evaluation radar_dot_bag simulate_drive nuscenes_to_bag
    evaluate_segmentation dataset_test simulation_benchmark)
expect_listed(COMMAND ${CMAKE_CTEST_COMMAND} -N
  WITH stamp_guard_test test_nodelets_replay replay_summary
  WITHOUT dataset_test scenario_test simulate_drive evaluate_segmentation)

# The tests' own packages are no need of a vehicle either.
foreach(package GTest rostest roslaunch benchmark)
  list(APPEND without -DCMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
endforeach()
configure(vehicle)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "The package does not configure without what its tests need:\n${log}")
endif()
expect_listed(COMMAND ${CMAKE_COMMAND} --build . --target help WITH radar_dot_nodelets WITHOUT stamp_guard_test)

# Who asks for a part is told what it lacks.
foreach(part TOOLS SIMULATION)
  configure(refused -DRADAR_DOT_WITH_${part}=ON)
  if(status EQUAL 0)
    message(FATAL_ERROR "RADAR_DOT_WITH_${part}=ON configures without its dependencies:\n${log}")
  endif()
  string(TOLOWER ${part} name)
  expect("radar_dot: RADAR_DOT_WITH_${part}=ON needs")
  expect("RapidJSON")
  expect("build without the ${name}: -DRADAR_DOT_WITH_${part}=OFF")
endforeach()
expect("Embree")
file(REMOVE_RECURSE ${SCRATCH})
