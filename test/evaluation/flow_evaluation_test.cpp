// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/evaluation/flow_evaluation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include "evaluation/flow_truth.h"
#include "evaluation/simulated_dataroot.h"
#include "fixtures/refusal.h"
#include "radar_dot/vision/camera_intrinsics.h"

namespace radar_dot::evaluation {
namespace {

namespace fs = std::filesystem;
using test::FixtureFlow;

/// A backend whose flow the test knows: from the size of the image and the expected flow, on any grid.
class KnownFlow : public OpticalFlow {
 public:
  using Answer = std::function<FlowField(const cv::Size&, const cv::Mat&)>;
  explicit KnownFlow(Answer answer) : answer_(std::move(answer)) {}
  FlowField compute(const cv::Mat& first, const cv::Mat&, const cv::Mat& expected) override {
    return answer_(first.size(), expected);
  }

 private:
  Answer answer_;
};

/// Makes it the backend "known".
void answerWith(const KnownFlow::Answer& answer) {
  registerOpticalFlow("known",
                      [answer](const OpticalFlowParams&) { return std::make_unique<KnownFlow>(answer); });
}

/// The same flow everywhere, px of the full image.
FlowField constant(const cv::Size& size, double u, double v) {
  return {cv::Mat(size, CV_32FC2, cv::Scalar(u, v)), {}};
}

class FixtureFlowEvaluation : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    fixture_ = std::make_unique<test::NuscenesFixture>();
    FixtureFlow::write(*fixture_);
    tables_ = std::make_unique<dataset::Tables>(dataset::Tables::load(fixture_->dataroot(), {}));
  }
  static FlowReport evaluate(const std::string& flow, int working_width = 160) {
    FlowEvaluationOptions options;
    options.optical_flow.flow.backend = flow;
    options.optical_flow.flow.working_width = options.depth.working_width = working_width;
    options.pairs.max_pairs = 2;
    return evaluateFlow(*tables_, 0, options);
  }
  static inline std::unique_ptr<test::NuscenesFixture> fixture_;
  static inline std::unique_ptr<dataset::Tables> tables_;
};

TEST_F(FixtureFlowEvaluation, AShiftIsTheErrorOnEveryGrid) {
  answerWith([](const cv::Size& size, const cv::Mat&) {
    return constant(size, FixtureFlow::kStaticFlow[0] + 3.0, FixtureFlow::kStaticFlow[1] + 4.0);
  });
  const double of_movers = std::hypot(FixtureFlow::kStaticFlow[0] + 3.0 - FixtureFlow::kMoverFlow[0],
                                      FixtureFlow::kStaticFlow[1] + 4.0 - FixtureFlow::kMoverFlow[1]);
  for (const int width : {0, 800, 160}) {
    SCOPED_TRACE(width);
    const FlowReport report = evaluate("known", width);
    const int grid_width = width == 0 ? FixtureFlow::size().width : width;
    const int grid_height = grid_width * 9 / 16;
    const double pixels = 2.0 * grid_width * grid_height;  // of two pairs
    EXPECT_EQ(report.scene, "scene-0001");
    EXPECT_EQ(report.pairs, 2U);
    EXPECT_EQ(report.seconds.size(), 2U);
    const auto expect = [](const FlowErrors::Group& group, double count, double error) {
      EXPECT_NEAR(static_cast<double>(group.true_pixels), count, 0.5);
      EXPECT_EQ(group.compared, group.true_pixels);
      EXPECT_NEAR(group.mean(), error, 1e-5);
      EXPECT_NEAR(group.median(), error, 0.003 * error);
      EXPECT_EQ(group.outlierShare(), 1.0);
    };
    expect(report.errors.still, (FixtureFlow::kVisible - FixtureFlow::kMoving) * pixels, 5.0);
    expect(report.errors.moving, FixtureFlow::kMoving * pixels, of_movers);
    EXPECT_EQ(report.errors.still.true_pixels + report.errors.moving.true_pixels,
              report.errors.all.true_pixels);
  }
}

// The movers' flow differs by 20 px from that of the static world. What is occluded or leaves the image may
// be as wrong as it likes.
TEST_F(FixtureFlowEvaluation, MoversCountApartAndOccludedPixelsNotAtAll) {
  answerWith([](const cv::Size& size, const cv::Mat&) {
    FlowField field = constant(size, FixtureFlow::kStaticFlow[0], FixtureFlow::kStaticFlow[1]);
    field.flow.colRange(0, size.width / 10) = cv::Scalar(1000.0, 0.0);
    field.flow.colRange(size.width - size.width / 10, size.width) = cv::Scalar(1000.0, 0.0);
    return field;
  });
  const FlowErrors errors = evaluate("known", 0).errors;
  EXPECT_EQ(errors.still.sum, 0.0);
  EXPECT_EQ(errors.still.outliers, 0U);
  EXPECT_NEAR(errors.moving.mean(), 20.0, 1e-5);
  EXPECT_EQ(errors.moving.outlierShare(), 1.0);
  EXPECT_NEAR(errors.all.mean(), 20.0 * FixtureFlow::kMoving / FixtureFlow::kVisible, 1e-5);
}

TEST_F(FixtureFlowEvaluation, FlowThatIsNotValidIsMissing) {
  answerWith([](const cv::Size& size, const cv::Mat&) {
    FlowField field = constant(size, FixtureFlow::kStaticFlow[0], FixtureFlow::kStaticFlow[1]);
    field.valid = cv::Mat(size, CV_8UC1, cv::Scalar(255));
    field.valid.rowRange(size.height / 2, size.height) = 0;
    field.flow.rowRange(size.height / 2, size.height) = cv::Scalar(500.0, 500.0);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    field.flow.rowRange(size.height / 10, size.height / 5) = cv::Scalar(nan, nan);
    return field;
  });
  const FlowErrors errors = evaluate("known", 0).errors;
  // Of rows 1/10 to 1, those from 1/5 to 1/2 have flow.
  EXPECT_NEAR(errors.all.density(), 3.0 / 9.0, 1e-12);
  EXPECT_EQ(errors.still.sum, 0.0);
}

TEST_F(FixtureFlowEvaluation, TheTruthHasNoErrorFromFilesEither) {
  const FlowReport exact = evaluate("ground_truth");
  EXPECT_EQ(exact.errors.all.sum, 0.0);
  EXPECT_EQ(exact.errors.all.density(), 1.0);
  EXPECT_TRUE(exact.seconds.empty());
  FlowEvaluationOptions options;
  options.optical_flow.flow.backend = "files";
  options.pairs.flow_directory = (fixture_->dataroot() / "ground_truth" / "keyframe_flow").string();
  options.optical_flow.flow.working_width = options.depth.working_width = 0;
  options.pairs.max_pairs = 1;
  const FlowReport report = evaluateFlow(*tables_, 0, options);
  EXPECT_EQ(report.errors.all.sum, 0.0);
  EXPECT_EQ(report.errors.all.density(), 1.0);
}

TEST_F(FixtureFlowEvaluation, RefusesWhatItDoesNotKnow) {
  const auto expect = [](const FlowEvaluationOptions& options, const std::vector<std::string>& parts) {
    test::expectRefusal<std::exception>([&options] { evaluateFlow(*tables_, 0, options); }, parts);
  };
  FlowEvaluationOptions options;
  options.pairs.pairs = ImagePairs::kNext;  // which has no files
  expect(options, {"ground_truth/flow", "simulated"});
  options = {};
  options.optical_flow.flow.backend = "telepathy";
  expect(options, {"telepathy", "dis"});
  options = {};
  options.optical_flow.flow.backend = "files";
  expect(options, {"flow_directory"});
  options = {};
  options.pairs.camera = "CAM_ROOF";
  expect(options, {"CAM_ROOF"});
  options = {};
  options.optical_flow.flow.initialisation = FlowStart::kExpected;
  options.depth.depth.backend = "stereo";
  expect(options, {"stereo"});
}

class SimulatedFlowEvaluation : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { dataroot_ = std::make_unique<test::SimulatedDataroot>(); }
  static FlowReport evaluate(const FlowEvaluationOptions& options, dataset::Index scene = 0) {
    return evaluateFlow(dataroot_->tables(), scene, options);
  }
  static inline std::unique_ptr<test::SimulatedDataroot> dataroot_;
};

TEST_F(SimulatedFlowEvaluation, BothKindsOfPairsHaveTheirTruth) {
  for (const ImagePairs pairs : {ImagePairs::kKeyframes, ImagePairs::kNext}) {
    SCOPED_TRACE(std::string(toString(pairs)));
    FlowEvaluationOptions options;
    options.pairs.pairs = pairs;
    options.optical_flow.flow.backend = "ground_truth";
    const FlowReport exact = evaluate(options);
    EXPECT_GE(exact.pairs, 3U);
    EXPECT_GT(exact.errors.still.compared, 100000U);
    EXPECT_GT(exact.errors.moving.compared, 500U);
    EXPECT_EQ(exact.errors.all.sum, 0.0);
    EXPECT_EQ(exact.errors.all.density(), 1.0);
    EXPECT_EQ(evaluate(options, 1).errors.moving.true_pixels, 0U);
    options.optical_flow.flow.backend = "dis";
    EXPECT_LT(evaluate(options).errors.all.median(), pairs == ImagePairs::kNext ? 1.0 : 20.0);
  }
}

// The flow of a static world by exact depth and motion is the true flow of what does not move.
TEST_F(SimulatedFlowEvaluation, ExpectedIsTheFlowOfAStaticWorld) {
  answerWith([](const cv::Size&, const cv::Mat& expected) { return FlowField{expected.clone(), {}}; });
  FlowEvaluationOptions options;
  options.optical_flow.flow.backend = "known";
  options.depth.depth.backend = "ground_truth";
  options.optical_flow.flow.working_width = options.depth.working_width = 0;
  options.optical_flow.flow.initialisation = FlowStart::kExpected;
  const FlowErrors errors = evaluate(options).errors;
  EXPECT_GT(errors.still.density(), 0.98);  // depth ends at 256 m
  EXPECT_LT(errors.still.mean(), 0.1);
  EXPECT_GT(errors.moving.mean(), 5.0);
}

class FlowPair : public ::testing::Test {
 protected:
  FlowPair() {
    test::writeImage(files_.first, cv::Mat(90, 160, CV_8UC3, cv::Scalar(1, 2, 3)));
    test::writeImage(files_.second, cv::Mat(90, 160, CV_8UC3, cv::Scalar(1, 2, 3)));
    cv::Mat flow(90, 160, CV_32FC2, cv::Scalar(8.0, 6.0));
    flow.rowRange(0, 30) = cv::Scalar::all(std::numeric_limits<double>::quiet_NaN());
    test::writeFlow(files_.truth, flow);
    params_.backend = "known";
  }
  void expectRefusal(const std::vector<std::string>& parts) {
    test::expectRefusal<std::exception>([this] { evaluateFlow(files_, params_); }, parts);
  }
  test::TemporaryFolder folder_;
  FlowPairFiles files_{folder_.path() / "one.png", folder_.path() / "two.png", folder_.path() / "flow.png"};
  OpticalFlowParams params_;
};

TEST_F(FlowPair, KnownErrorsOnEveryGrid) {
  for (const int width : {0, 80}) {
    SCOPED_TRACE(width);
    params_.working_width = width;
    for (const bool on_grid : {false, true}) {
      answerWith([width, on_grid](const cv::Size& size, const cv::Mat&) {
        const double scale = on_grid && width != 0 ? static_cast<double>(width) / size.width : 1.0;
        return constant(on_grid ? workingGrid(size, width) : size, 8.0 * scale, 16.0 * scale);
      });
      const FlowReport report = evaluateFlow(files_, params_);
      EXPECT_EQ(report.scene, "one");
      EXPECT_EQ(report.pairs, 1U);
      EXPECT_EQ(report.seconds.size(), 1U);
      EXPECT_EQ(report.errors.all.compared, width == 0 ? 60U * 160U : 30U * 80U);
      EXPECT_NEAR(report.errors.all.mean(), 10.0, 1e-5);
      EXPECT_EQ(report.errors.still.true_pixels + report.errors.moving.true_pixels, 0U);
    }
  }
}

TEST_F(FlowPair, RefusesFilesThatDoNotFit) {
  answerWith([](const cv::Size& size, const cv::Mat&) { return constant(size, 0.0, 0.0); });
  params_.initialisation = FlowStart::kExpected;
  expectRefusal({"expected", "single pair"});
  params_.initialisation = FlowStart::kNone;
  params_.backend = "telepathy";
  expectRefusal({"telepathy"});
  params_.backend = "known";
  test::writeFlow(files_.truth, cv::Mat(45, 80, CV_32FC2, cv::Scalar(0.0, 0.0)));
  expectRefusal({"flow.png", "80x45", "160x90"});
  test::writeImage(files_.truth, cv::Mat(90, 160, CV_8UC1));
  expectRefusal({"flow.png", "KITTI"});
  fs::remove(files_.truth);
  expectRefusal({"flow.png", "not there"});
  test::writeImage(files_.second, cv::Mat(90, 80, CV_8UC1));
  expectRefusal({"flow.png"});
  fs::remove(files_.second);
  expectRefusal({"two.png", "not there"});
  test::writeFile(files_.first, "no image");
  expectRefusal({"one.png", "cannot be read"});
}

TEST(FlowReports, FiguresStandInTableAndFiles) {
  FlowReport report;
  report.scene = "scene-0001";
  report.pairs = 1;
  report.seconds = {0.010};
  report.errors.all.true_pixels = 4;
  report.errors.all.add(0.0, 1.0);
  report.errors.all.add(4.0, 1.0);
  FlowReport slower = report;
  slower.seconds = {0.030, 0.050};
  FlowReport overall = report;
  overall += slower;
  EXPECT_EQ(formatCsv({report}, overall),
            "scene,epe_all,epe_median_all,fl_all,density_all,epe_static,epe_median_static,fl_static,"
            "density_static,epe_moving,epe_median_moving,fl_moving,density_moving,ms_per_pair,pairs,"
            "true_pixels_all,compared_all,true_pixels_static,compared_static,true_pixels_moving,"
            "compared_moving\n"
            "scene-0001,2.000000,0.000000,0.500000,0.500000,,,,,,,,,10.000000,1,4,2,0,0,0,0\n"
            "overall,2.000000,0.000000,0.500000,0.500000,,,,,,,,,30.000000,2,8,4,0,0,0,0\n");
  const std::string table = formatTable({report}, overall);
  EXPECT_NE(table.find("scene-0001          1      2.000   0.000  50.0    50.0"), std::string::npos) << table;
  EXPECT_NE(table.find("Overall             2"), std::string::npos) << table;
}

}  // namespace
}  // namespace radar_dot::evaluation
