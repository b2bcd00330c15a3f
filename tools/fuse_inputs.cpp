// SPDX-License-Identifier: BSD-3-Clause
#include "tools/fuse_inputs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <optional>
#include <utility>

#include "lsv/ingest/csv_table.h"
#include "lsv/ingest/timestamps.h"

namespace lsv::cli {
namespace {

/// 73 years, as the navigator.
constexpr std::int64_t kFarthestTime_ns = (std::int64_t{1} << 61) - 1;
constexpr double kFastest_m_s = 1e4;
constexpr double kFastest_rad_s = 1e5;

class SampleTable {
 public:
  static Result<SampleTable> open(const std::string& path, std::vector<const char*> names) {
    Result<CsvTable> table = CsvTable::read(path);
    if (!table) return table.error();
    SampleTable out(std::move(table).value());
    names.insert(names.begin(), "time_s");
    for (const char* const name : names) {
      const Result<std::size_t> column = out.table_.column(name);
      if (!column) return column.error();
      out.columns_.push_back(column.value());
    }
    return out;
  }

  std::size_t rows() const { return table_.rows(); }
  /// Of the i-th name asked for; NaN where the cell is empty.
  Result<double> number(std::size_t row, std::size_t i, double largest) const {
    return checked(row, columns_[i + 1], largest);
  }
  /// NaN where there is no such column.
  Result<double> number_if_there(std::size_t row, const char* name, double largest) const {
    if (!table_.has(name)) return kUnknown;
    return checked(row, table_.column(name).value(), largest);
  }
  std::string_view text_if_there(std::size_t row, const char* name) const {
    if (!table_.has(name)) return {};
    return table_.text(row, table_.column(name).value());
  }
  /// Of the row; increases strictly.
  Result<Stamp> time(std::size_t row) {
    const std::string_view text = table_.text(row, columns_[0]);
    const std::optional<std::int64_t> ns = ns_from_decimal_seconds(text);
    if (!ns || std::abs(*ns) > kFarthestTime_ns)
      return at(row, "time_s is \"" + std::string(text) +
                         "\", not a time in seconds within 73 years of zero");
    if (last_ns_ && *ns <= *last_ns_) return at(row, "time_s does not increase");
    last_ns_ = ns;
    return Stamp{*ns};
  }
  Error at(std::size_t row, const std::string& sentence) const {
    return {ErrorCode::bad_input,
            table_.name() + ":" + std::to_string(table_.line(row)) + ": " + sentence};
  }

 private:
  explicit SampleTable(CsvTable table) : table_(std::move(table)) {}

  Result<double> checked(std::size_t row, std::size_t column, double largest) const {
    Result<double> value = table_.number(row, column);
    if (value && std::abs(value.value()) > largest)
      return at(row, "a value is beyond what a rover does");
    return value;
  }

  CsvTable table_;
  std::vector<std::size_t> columns_;
  std::optional<std::int64_t> last_ns_;
};

/// What the tracks say of rest. A rover that turns about the place of one sensor does not stand.
class RestWords {
 public:
  void add(std::size_t sensor, Stamp when, std::string_view motion) {
    words_[sensor].push_back({when, motion == "moving"});
    if (motion == "at_rest") rests_.push_back({when, sensor});
  }
  /// Of the times at which a sensor is at rest and the last word of no other is that it moves.
  std::vector<FuseSample> standstills() {
    for (std::vector<Word>& words : words_) std::ranges::stable_sort(words, {}, time_of);
    std::vector<FuseSample> out;
    for (const Rest& rest : rests_) {
      if (!moves(rest)) out.push_back({rest.when, 0, StandstillSample{.stamp = rest.when}});
    }
    return out;
  }

 private:
  struct Word {
    Stamp when;
    bool moves;
  };
  struct Rest {
    Stamp when;
    std::size_t sensor;
  };

  static std::int64_t time_of(const Word& word) { return word.when.ns; }
  bool moves(const Rest& rest) const {
    for (std::size_t i = 0; i < words_.size(); ++i) {
      if (i == rest.sensor) continue;
      const auto after = std::ranges::upper_bound(words_[i], rest.when.ns, {}, time_of);
      if (after != words_[i].begin() && std::prev(after)->moves) return true;
    }
    return false;
  }

  std::array<std::vector<Word>, kMaxLsvSensors> words_;
  std::vector<Rest> rests_;
};

Result<void> add_lsv(const std::string& path, std::size_t sensor, FuseSamples& out,
                     RestWords& rest) {
  Result<SampleTable> opened = SampleTable::open(path, {"vx_m_s", "vy_m_s"});
  if (!opened) return opened.error();
  SampleTable& table = opened.value();
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const Result<Stamp> time = table.time(row);
    if (!time) return time.error();
    const std::string_view status = table.text_if_there(row, "status");
    LsvSample sample{.stamp = time.value()};
    const std::pair<Result<double>, double*> cells[] = {
        {table.number(row, 0, kFastest_m_s), &sample.vx_m_s},
        {table.number(row, 1, kFastest_m_s), &sample.vy_m_s},
        {table.number_if_there(row, "sigma_vx_m_s", kFastest_m_s), &sample.sigma_vx_m_s},
        {table.number_if_there(row, "sigma_vy_m_s", kFastest_m_s), &sample.sigma_vy_m_s},
        {table.number_if_there(row, "dt_s", 1e6), &sample.interval_s}};
    for (const auto& [value, target] : cells) {
      if (!value) return value.error();
      *target = value.value();
    }
    if (!status.empty() && status != "ok") {
      ++out.rows_left_out;
      continue;
    }
    if (std::isnan(sample.vx_m_s) || std::isnan(sample.vy_m_s)) {
      ++out.rows_left_out;
      continue;
    }
    if (std::isnan(sample.interval_s)) sample.interval_s = 0.0;
    if (sample.interval_s < 0.0) return table.at(row, "dt_s is below 0");
    if (sample.sigma_vx_m_s <= 0.0 || sample.sigma_vy_m_s <= 0.0)
      return table.at(row, "a sigma is not above 0");
    const auto half_ns = static_cast<std::int64_t>(sample.interval_s / 2.0 * 1e9);
    const Stamp when{sample.stamp.ns - half_ns};
    out.samples.push_back({when, sensor, sample});
    rest.add(sensor, when, table.text_if_there(row, "motion"));
  }
  return {};
}

Result<void> add_wheels(const std::string& path, FuseSamples& out) {
  Result<SampleTable> opened = SampleTable::open(path, {"left_rad_s", "right_rad_s"});
  if (!opened) return opened.error();
  SampleTable& table = opened.value();
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const Result<Stamp> time = table.time(row);
    if (!time) return time.error();
    const Result<double> left = table.number(row, 0, kFastest_rad_s);
    if (!left) return left.error();
    const Result<double> right = table.number(row, 1, kFastest_rad_s);
    if (!right) return right.error();
    if (std::isnan(left.value()) || std::isnan(right.value())) {
      ++out.rows_left_out;
      continue;
    }
    out.samples.push_back(
        {time.value(), 0, WheelSample{time.value(), left.value(), right.value()}});
  }
  return {};
}

Result<void> add_imu(const std::string& path, FuseSamples& out) {
  Result<SampleTable> opened = SampleTable::open(path, {"wz_rad_s"});
  if (!opened) return opened.error();
  SampleTable& table = opened.value();
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const Result<Stamp> time = table.time(row);
    if (!time) return time.error();
    const Result<double> rate = table.number(row, 0, kFastest_rad_s);
    if (!rate) return rate.error();
    if (std::isnan(rate.value())) {
      ++out.rows_left_out;
      continue;
    }
    out.samples.push_back({time.value(), 0, GyroSample{time.value(), rate.value()}});
  }
  return {};
}

Error usage(std::string sentence) { return {ErrorCode::invalid_argument, std::move(sentence)}; }

Result<void> fits(const FuseInputs& inputs, const FusionConfig& config) {
  if (!inputs.wheels.empty() && !config.wheels)
    return usage("--wheels is given, but the rover has no section [wheels]");
  if (!inputs.imu.empty() && !config.gyro)
    return usage("--imu is given, but the rover has no section [imu]");
  if (inputs.lsv.size() > config.lsv.size())
    return usage("--lsv is given " + std::to_string(inputs.lsv.size()) +
                 " times, but the rover has " + std::to_string(config.lsv.size()) +
                 " sections [[lsv]]");
  if (inputs.lsv.empty() && inputs.wheels.empty())
    return usage("give --lsv, --wheels or both: nothing else tells how far the rover went");
  return {};
}

}  // namespace

Result<FuseSamples> read_samples(const FuseInputs& inputs, const FusionConfig& config) {
  if (Result<void> ok = fits(inputs, config); !ok) return ok.error();
  FuseSamples out;
  RestWords rest;
  for (std::size_t i = 0; i < inputs.lsv.size(); ++i) {
    if (Result<void> added = add_lsv(inputs.lsv[i], i, out, rest); !added) return added.error();
  }
  std::ranges::copy(rest.standstills(), std::back_inserter(out.samples));
  if (!inputs.wheels.empty()) {
    if (Result<void> added = add_wheels(inputs.wheels, out); !added) return added.error();
  }
  if (!inputs.imu.empty()) {
    if (Result<void> added = add_imu(inputs.imu, out); !added) return added.error();
  }
  if (out.samples.empty())
    return Error{ErrorCode::bad_input, "the files hold no sample that can be used"};
  std::ranges::stable_sort(out.samples, {}, &FuseSample::when);
  return out;
}

}  // namespace lsv::cli
