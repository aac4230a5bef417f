// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// Two images, depth and the motion of the camera in, mask of what moves by itself out.
#include <radar_dot/vision/image_pair_mask.h>

#include <cstdio>
#include <opencv2/imgproc.hpp>

int main() {
  // A wall 10 m ahead. The camera goes 0.2 m to the left, so that the wall goes 1000 px * 0.2 m / 10 m = 20
  // px to the right; but a board on it goes 30 px down.
  const radar_dot::CameraIntrinsics camera{1000.0, 1000.0, 639.5, 359.5, 1280, 720};
  const cv::Rect board(500, 250, 250, 200);
  cv::Mat wall(760, 1340, CV_8UC1);
  cv::theRNG().state = 1;
  cv::randu(wall, 0, 255);
  cv::GaussianBlur(wall, wall, {}, 4.0);
  cv::normalize(wall, wall, 0, 255, cv::NORM_MINMAX);
  const auto image = [&](int wall_right, int board_down) {
    cv::Mat result = wall(cv::Rect(20 - wall_right, 20, camera.width, camera.height)).clone();
    wall(cv::Rect({0, 0}, board.size())).copyTo(result(board + cv::Point(0, board_down)));
    return result;
  };
  const cv::Mat depth(camera.height, camera.width, CV_32FC1, cv::Scalar(10.0));
  const Eigen::Isometry3d motion(Eigen::Translation3d(0.2, 0.0, 0.0));  // of points as the camera sees them

  const cv::Mat mask = radar_dot::imagePairMask(image(0, 0), image(20, 30), depth, camera, motion);
  const int on_board = cv::countNonZero(mask(board));
  std::printf("%d %% of the board, %d %% of the wall\n", 100 * on_board / board.area(),
              100 * (cv::countNonZero(mask) - on_board) / (camera.width * camera.height - board.area()));
}
