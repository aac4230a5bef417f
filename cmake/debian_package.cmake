# What cpack makes in a build folder: a Debian package. See docs/development.md.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME radar-dot)
set(CPACK_PACKAGE_CONTACT "The Radar-Dot developers <radar-dot@users.noreply.github.com>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "ego velocity, odometry and masks of what moves from Doppler radar, for ROS 1")
set(CPACK_PACKAGING_INSTALL_PREFIX ${CMAKE_INSTALL_PREFIX})
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
# Libraries are found by dpkg-shlibdeps. ROS Noetic has other names for the rest.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
if(NOT EXISTS /opt/ros/noetic)
  set(CPACK_DEBIAN_PACKAGE_DEPENDS "libnodeletlib-tools, python3-roslaunch, python3-rosmaster, python3-rospy, \
python3-rosbag, python3-diagnostic-msgs, python3-visualization-msgs, python3-sensor-msgs, python3-geometry-msgs, python3-nav-msgs, python3-tf2-msgs, python3-numpy, python3-pil, \
python3-matplotlib, python3-yaml, rosbash, rospack-tools")
  set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "rviz, librosbag-dev, ffmpeg")
endif()
include(CPack)
