// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "torch_model.h"

#include <ATen/Parallel.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <torch/cuda.h>
#include <torch/script.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <thread>
#include <tuple>
#include <utility>

namespace radar_dot {
namespace {

// The executor watches the first call and compiles in the second; the third is as quick as all later ones.
constexpr int kWarmUpCalls = 2;

/// The line of a message of libtorch that says what is wrong: of errors in a network's own code, which come
/// with a trace of it, the last.
std::string oneLine(const std::exception& error) {
  const auto* torch_error = dynamic_cast<const c10::Error*>(&error);
  const std::string text = torch_error != nullptr ? torch_error->what_without_backtrace() : error.what();
  std::string line;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string each = text.substr(begin, end - begin);
    begin = end + 1;
    if (each.find_first_not_of(" \t") == std::string::npos) continue;
    const bool is_error = each.find("Error: ") != std::string::npos;
    if (line.empty() || is_error) line = each;
  }
  return line;
}

std::string shapeText(at::IntArrayRef shape) {
  std::string sides;
  for (const std::int64_t side : shape) sides += (sides.empty() ? "" : ", ") + std::to_string(side);
  return "(" + sides + ")";
}

at::IntArrayRef sizesOf(const TensorShape& shape) { return {shape.data(), shape.size()}; }

std::string inputText(const NetworkSignature& signature) {
  std::string text;
  for (const TensorShape& shape : signature.inputs)
    text += (text.empty() ? "" : " and ") + shapeText(sizesOf(shape));
  return text;
}

at::Device deviceNamed(const std::string& name) {
  const bool has_cuda = torch::cuda::is_available();
  if (name == "auto") return {has_cuda ? at::kCUDA : at::kCPU};
  const std::string cuda_number = name.rfind("cuda:", 0) == 0 ? name.substr(5) : "";
  const bool is_number = !cuda_number.empty() && cuda_number.size() < 4 &&
                         std::all_of(cuda_number.begin(), cuda_number.end(),
                                     [](unsigned char c) { return std::isdigit(c) != 0; });
  if (name != "cpu" && name != "cuda" && !is_number)
    throw std::invalid_argument(
        fmt::format("device '{}' is not one of auto, cpu, cuda, cuda:<number>", name));
  if (name == "cpu") return {at::kCPU};
  if (!has_cuda) {
    throw std::invalid_argument(fmt::format(
        "device '{}': this libtorch or this machine has no CUDA; take cpu or auto, or build with a "
        "libtorch for CUDA (Torch_DIR)",
        name));
  }
  const int index = is_number ? std::stoi(cuda_number) : 0;
  if (index >= static_cast<int>(torch::cuda::device_count())) {
    throw std::invalid_argument(
        fmt::format("device '{}': there are {} CUDA devices", name, torch::cuda::device_count()));
  }
  return {at::kCUDA, static_cast<c10::DeviceIndex>(index)};
}

class Network : public TorchModel {
 public:
  Network(const NetworkParams& params, at::Device device, NetworkSignature signature)
      : file_(params.model), device_(device), signature_(std::move(signature)) {
    load();
    prove(params.threads);
  }

  cv::Mat run(const std::vector<const float*>& inputs, int threads) override {
    if (inputs.size() != signature_.inputs.size())
      throw std::invalid_argument(fmt::format("model '{}' takes {} inputs", file_, signature_.inputs.size()));
    const std::lock_guard<std::mutex> lock(mutex_);
    try {
      return call(inputs, threads);
    } catch (const std::exception& error) {
      throw std::runtime_error(fmt::format("model '{}' failed: {}", file_, oneLine(error)));
    }
  }

 private:
  void load() {
    try {
      module_ = torch::jit::load(file_, device_);
      module_.eval();
    } catch (const std::exception& error) {
      throw std::invalid_argument(
          fmt::format("model '{}' is not TorchScript that this libtorch can read: {}; "
                      "{} makes such files",
                      file_, oneLine(error), signature_.maker));
    }
  }

  /// Calls the network as it will be called, which warms it up as well.
  void prove(int threads) {
    std::vector<std::vector<float>> values;
    std::vector<const float*> inputs;
    for (const TensorShape& shape : signature_.inputs) {
      std::int64_t count = 1;
      for (const std::int64_t side : shape) count *= side;
      values.emplace_back(static_cast<std::size_t>(count), 0.5F);
      inputs.push_back(values.back().data());
    }
    for (int i = 0; i < kWarmUpCalls; ++i) {
      try {
        call(inputs, threads);
      } catch (const std::invalid_argument&) {
        throw;
      } catch (const std::exception& error) {
        throw std::invalid_argument(
            fmt::format("model '{}' does not take float tensors of {}: {}; {} makes "
                        "such files",
                        file_, inputText(signature_), oneLine(error), signature_.maker));
      }
    }
  }

  cv::Mat call(const std::vector<const float*>& inputs, int threads) {
    const c10::InferenceMode no_gradients;
    at::set_num_threads(threads > 0 ? threads
                                    : std::max(1, static_cast<int>(std::thread::hardware_concurrency())));
    std::vector<c10::IValue> tensors;
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      // The values are only read; from_blob has no way of saying so.
      tensors.emplace_back(
          at::from_blob(const_cast<float*>(inputs[i]), sizesOf(signature_.inputs[i]), at::kFloat)
              .to(device_));
    }
    const c10::IValue result = module_.forward(std::move(tensors));
    const std::string wanted = shapeText(sizesOf(signature_.output));
    if (!result.isTensor()) {
      throw std::invalid_argument(fmt::format("model '{}' gives a {} where one tensor of {} is wanted", file_,
                                              result.tagKind(), wanted));
    }
    at::Tensor tensor = result.toTensor();
    if (tensor.sizes() != sizesOf(signature_.output) || !tensor.is_floating_point()) {
      throw std::invalid_argument(fmt::format("model '{}' gives {} of {} where float of {} is wanted", file_,
                                              c10::toString(tensor.scalar_type()), shapeText(tensor.sizes()),
                                              wanted));
    }
    tensor = tensor.to(at::kCPU, at::kFloat).contiguous();
    const TensorShape& shape = signature_.output;
    return cv::Mat(static_cast<int>(shape[0] * shape[1] * shape[2]), static_cast<int>(shape[3]), CV_32FC1,
                   tensor.data_ptr<float>())
        .clone();
  }

  std::string file_;
  at::Device device_;
  NetworkSignature signature_;
  torch::jit::Module module_;
  std::mutex mutex_;
};

/// Tells one network from another; a file that was rewritten is another.
using Key = std::tuple<std::string, std::filesystem::file_time_type, std::string, std::vector<TensorShape>,
                       TensorShape>;

struct Loaded {
  std::mutex mutex;
  std::map<Key, std::weak_ptr<TorchModel>> networks;
};

Loaded& loaded() {
  static Loaded instance;
  return instance;
}

}  // namespace

std::shared_ptr<TorchModel> TorchModel::load(const NetworkParams& params, const NetworkSignature& signature) {
  if (params.model.empty()) {
    throw std::invalid_argument(
        fmt::format("model: no file is given; {} makes one (TorchScript)", signature.maker));
  }
  std::error_code error;
  if (!std::filesystem::is_regular_file(params.model, error))
    throw std::invalid_argument(fmt::format("model '{}': there is no such file", params.model));
  const at::Device device = deviceNamed(params.device);
  const Key key(params.model, std::filesystem::last_write_time(params.model, error), device.str(),
                signature.inputs, signature.output);
  Loaded& known = loaded();
  const std::lock_guard<std::mutex> lock(known.mutex);  // held while loading, so that it is loaded once
  if (std::shared_ptr<TorchModel> shared = known.networks[key].lock()) return shared;
  auto network = std::make_shared<Network>(params, device, signature);
  known.networks[key] = network;
  return network;
}

}  // namespace radar_dot
