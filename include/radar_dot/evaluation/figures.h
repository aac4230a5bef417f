// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <sstream>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

// The one declaration of a figure. A report lists what it holds once:
//
//     struct ToyReport {
//       std::string scene;
//       std::uint64_t images = 0;
//       Mean error;  // m
//       void describe(Figures& figures) {
//         figures.name(scene);
//         figures.mean("mae", error);
//         figures.sum("images", images);
//       }
//     };
//
// The sum of scenes, JSON and what it is merged from, CSV and the cells of tables are all derived from the
// list.

namespace radar_dot::evaluation {

/// NaN where there is no whole.
inline double ratio(double part, std::uint64_t whole) {
  return whole == 0 ? std::numeric_limits<double>::quiet_NaN() : part / static_cast<double>(whole);
}
inline double ratio(std::uint64_t part, std::uint64_t whole) {
  return ratio(static_cast<double>(part), whole);
}
double meanAbsolute(const std::vector<double>& values);    ///< NaN where there are none
double medianAbsolute(const std::vector<double>& values);  ///< NaN where there are none

/// A mean that can be merged with others.
struct Mean {
  double sum = 0.0;
  std::uint64_t count = 0;
  void add(double value) {
    sum += value;
    ++count;
  }
  double value() const { return ratio(sum, count); }  ///< NaN where nothing was added
  Mean& operator+=(const Mean& other) {
    sum += other.sum;
    count += other.count;
    return *this;
  }
};

class Figures;

template <typename Report, typename = void>
struct HasFigures : std::false_type {};
template <typename Report>
struct HasFigures<Report, std::void_t<decltype(std::declval<Report&>().describe(std::declval<Figures&>()))>>
    : std::true_type {};

/// Adds members of reports: numbers add up, lists are joined, and maps, pairs and arrays add up entry by
/// entry.
struct AddMember {
  template <typename Value>
  void operator()(Value& into, const Value& from) const {
    into += from;
  }
  template <typename Value>
  void operator()(std::vector<Value>& into, const std::vector<Value>& from) const {
    into.insert(into.end(), from.begin(), from.end());
  }
  template <typename First, typename Second>
  void operator()(std::pair<First, Second>& into, const std::pair<First, Second>& from) const {
    (*this)(into.first, from.first);
    (*this)(into.second, from.second);
  }
  template <typename Key, typename Value>
  void operator()(std::map<Key, Value>& into, const std::map<Key, Value>& from) const {
    for (const auto& [key, value] : from) (*this)(into[key], value);
  }
  template <typename Value, std::size_t size>
  void operator()(std::array<Value, size>& into, const std::array<Value, size>& from) const {
    for (std::size_t i = 0; i < size; ++i) (*this)(into[i], from[i]);
  }
};

/// What adds up in a report as a text without rounding, and read back from it: of the same members as
/// AddMember.
class SumsText {
 public:
  SumsText() = default;                                                      ///< to be written
  explicit SumsText(const std::string& text) : text_(text), reads_(true) {}  ///< to be read

  std::string text() const { return text_.str(); }
  /// Was the text read to its end, and nothing else in it?
  bool isRead() { return !failed_ && (text_ >> std::ws).eof(); }

  void operator()(std::uint64_t& count);
  void operator()(double& number);
  void operator()(std::string& word);
  void operator()(Mean& mean) {
    (*this)(mean.sum);
    (*this)(mean.count);
  }
  template <typename Report>
  void operator()(Report& report) {
    figuresOf(report).keepParts(*this);
  }
  template <typename Value>
  void operator()(std::vector<Value>& list) {
    list.resize(size(list.size()));
    for (Value& value : list) (*this)(value);
  }
  template <typename Value>
  void operator()(std::map<std::string, Value>& map) {
    std::vector<std::string> keys;
    for (const auto& entry : map) keys.push_back(entry.first);
    (*this)(keys);
    for (const std::string& key : keys) (*this)(map[key]);
  }
  /// Most of a histogram is zero.
  template <std::size_t bins>
  void operator()(std::array<std::uint64_t, bins>& histogram) {
    const auto zeros = static_cast<std::size_t>(std::count(histogram.begin(), histogram.end(), 0U));
    const std::size_t filled = size(bins - zeros);
    std::uint64_t bin = 0;
    for (std::size_t i = 0; i < filled; ++i, ++bin) {
      while (!reads_ && histogram[bin] == 0) ++bin;
      (*this)(bin);
      failed_ = failed_ || bin >= bins;
      if (failed_) return;
      (*this)(histogram[bin]);
    }
  }

 private:
  std::string next();
  /// No list is longer than its text.
  std::size_t size(std::size_t count);

  std::stringstream text_;
  bool reads_ = false, failed_ = false;
};

/// The figures of one report, which must outlive it.
class Figures {
 public:
  /// In the order in which a file without nested objects has them; kColumn is in tables alone.
  enum class Kind { kFigure, kCount, kSum, kColumn, kBegin, kEnd };
  struct Item {
    std::string key;  ///< with those of the objects it is in: "models/planar/vx_mae"
    Kind kind = Kind::kFigure;
    double number = 0.0;  ///< NaN: there is none
    std::uint64_t count = 0;
    void* member = nullptr;  ///< std::uint64_t or double that is summed; null: computed
  };

  void name(const std::string& scene) { name_ = scene; }
  /// Computed from the others.
  void figure(const std::string& key, double value) { add(key, Kind::kFigure, value); }
  void count(const std::string& key, std::uint64_t value) { add(key, Kind::kCount, 0.0, value); }
  /// A figure that is in no file.
  void column(const std::string& key, double value) { add(key, Kind::kColumn, value); }
  /// A member that is written and adds up.
  void sum(const std::string& key, std::uint64_t& count) {
    add(key, Kind::kCount, 0.0, count, &count);
    part(count);
  }
  void sum(const std::string& key, double& number) {
    add(key, Kind::kSum, number, 0, &number);
    part(number);
  }
  void mean(const std::string& key, Mean& mean) {
    figure(key, mean.value());
    part(mean);
  }
  /// A member that adds up and is not written.
  template <typename Part>
  void part(Part& part) {
    if (is_shown_only_) return;
    parts_.push_back({&part,
                      [](void* into, const void* from) {
                        AddMember()(*static_cast<Part*>(into), *static_cast<const Part*>(from));
                      },
                      [](void* member, SumsText& text) { text(*static_cast<Part*>(member)); }});
  }
  /// What a member describes; its keys are followed by the suffix.
  template <typename Part>
  void group(Part& part, const std::string& suffix = "") {
    const std::string before = std::exchange(suffix_, suffix);
    part.describe(*this);
    suffix_ = before;
  }
  /// The same, written only.
  template <typename Part>
  void show(const Part& part, const std::string& suffix = "") {
    const bool before = std::exchange(is_shown_only_, true);
    group(const_cast<Part&>(part), suffix);
    is_shown_only_ = before;
  }
  /// A nested object of what `describe()` adds.
  template <typename Describe>
  void object(const std::string& key, const Describe& describe) {
    add(key, Kind::kBegin);
    const std::string before = std::exchange(path_, path_ + key + "/");
    describe();
    path_ = before;
    add(key, Kind::kEnd);
  }

  const std::string& name() const { return name_; }
  const std::vector<Item>& items() const { return items_; }
  /// Null where there is none.
  const Item* find(const std::string& key) const;
  /// Adds the parts of a report of the same type to those of this one.
  void addParts(const Figures& other) const;
  /// Writes the parts of the report to the text, or reads them from it.
  void keepParts(SumsText& text) const;
  /// Text of the parts; empty where there are none.
  std::string sums() const;
  /// Sets the parts. @throws std::runtime_error naming `where` for what is not sums() of such a report
  void readSums(const std::string& text, const std::string& where) const;
  /// Without nested objects: by kind, otherwise as declared.
  void sort();

 private:
  struct Part {
    void* member;
    void (*add)(void* into, const void* from);
    void (*keep)(void* member, SumsText& text);
  };

  void add(const std::string& key, Kind kind, double number = 0.0, std::uint64_t count = 0,
           void* member = nullptr);

  std::string name_, path_, suffix_;
  bool is_shown_only_ = false;
  std::vector<Item> items_;
  std::vector<Part> parts_;
};

template <typename Report>
Figures figuresOf(const Report& report) {
  Figures figures;
  // Describing does not change a report; who holds a const one must not add to its parts.
  const_cast<Report&>(report).describe(figures);
  figures.sort();
  return figures;
}
template <typename Report>
std::vector<Figures> figuresOf(const std::vector<Report>& reports) {
  std::vector<Figures> all;
  for (const Report& report : reports) all.push_back(figuresOf(report));
  return all;
}

/// Merges two reports.
template <typename Report, typename = std::enable_if_t<HasFigures<Report>::value>>
Report& operator+=(Report& report, const Report& other) {
  figuresOf(report).addParts(figuresOf(other));
  return report;
}

std::string jsonOf(const std::vector<Figures>& scenes, const Figures& overall);
std::string csvOf(const std::vector<Figures>& scenes, const Figures& overall);

/// {"scenes": [{"scene", figures, counts, sums}], "overall": {same keys}}. Figures that do not exist are
/// null. Each has its SumsText as "sums", from which reports are merged.
template <typename Report>
std::string formatJson(const std::vector<Report>& scenes, const Report& overall) {
  return jsonOf(figuresOf(scenes), figuresOf(overall));
}
/// The same as columns: a line for each scene, and one "overall".
template <typename Report>
std::string formatCsv(const std::vector<Report>& scenes, const Report& overall) {
  return csvOf(figuresOf(scenes), figuresOf(overall));
}

}  // namespace radar_dot::evaluation
