// SPDX-License-Identifier: BSD-3-Clause
#include "tools/fuse_inputs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <optional>
#include <system_error>
#include <utility>

#include "lsv/ingest/csv_table.h"
#include "lsv/ingest/timestamps.h"
#include "lsv/output/number_text.h"

namespace lsv::cli {
namespace {

/// 73 years, as the navigator.
constexpr std::int64_t kFarthestTime_ns = (std::int64_t{1} << 61) - 1;
constexpr double kFastest_m_s = 1e4;
constexpr double kFastest_rad_s = 1e5;

struct TimeRange {
  std::string name;
  Stamp begin;
  Stamp end;
};

std::string text_of(const TimeRange& range) {
  constexpr double kS = 1e-9;
  return range.name + formatted(" is from %.10g to %.10g s",
                                kS * static_cast<double>(range.begin.ns),
                                kS * static_cast<double>(range.end.ns));
}

/// Where no file spans two of them, clocks are not one, and the time in between is made up.
Result<void> are_of_one_clock(std::vector<TimeRange> ranges) {
  std::ranges::sort(ranges, {}, &TimeRange::begin);
  for (std::size_t i = 1; i < ranges.size(); ++i) {
    const TimeRange& before = *std::ranges::max_element(
        ranges.begin(), ranges.begin() + static_cast<std::ptrdiff_t>(i), {}, &TimeRange::end);
    if (before.end >= ranges[i].begin) continue;
    return Error{ErrorCode::bad_input, "the times do not overlap: " + text_of(before) + ", " +
                                           text_of(ranges[i]) + "; all files must be on one clock"};
  }
  return {};
}

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
    if (!first_ns_) first_ns_ = ns;
    last_ns_ = ns;
    return Stamp{*ns};
  }
  /// Of the rows whose time was asked for; nothing without any.
  std::optional<TimeRange> range() const {
    if (!first_ns_) return std::nullopt;
    return TimeRange{table_.name(), {*first_ns_}, {*last_ns_}};
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
  std::optional<std::int64_t> first_ns_;
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

/// `ok` and no word are used; a word that is none is a mistake, not a refusal.
Result<bool> is_ok(const SampleTable& table, std::size_t row) {
  const std::string_view status = table.text_if_there(row, "status");
  if (status.empty() || status == word(ShiftStatus::ok)) return true;
  for (const ShiftStatus known : kAllShiftStatuses) {
    if (status == word(known)) return false;
  }
  return table.at(row, "status is \"" + std::string(status) +
                           "\", which is no status of lsv track (docs/conventions.md)");
}

Result<std::optional<TimeRange>> add_lsv(const std::string& path, std::size_t sensor,
                                         FuseSamples& out, RestWords& rest) {
  Result<SampleTable> opened = SampleTable::open(path, {"vx_m_s", "vy_m_s"});
  if (!opened) return opened.error();
  SampleTable& table = opened.value();
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const Result<Stamp> time = table.time(row);
    if (!time) return time.error();
    const Result<bool> ok = is_ok(table, row);
    if (!ok) return ok.error();
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
    if (!ok.value() || std::isnan(sample.vx_m_s) || std::isnan(sample.vy_m_s)) {
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
  out.rows_read += table.rows();
  return table.range();
}

Result<std::optional<TimeRange>> add_wheels(const std::string& path, FuseSamples& out) {
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
  out.rows_read += table.rows();
  return table.range();
}

Result<std::optional<TimeRange>> add_imu(const std::string& path, FuseSamples& out) {
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
  out.rows_read += table.rows();
  return table.range();
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
  for (std::size_t i = 1; i < inputs.lsv.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      std::error_code ignored;  // what does not exist is told when it is read
      if (std::filesystem::equivalent(inputs.lsv[i], inputs.lsv[j], ignored))
        return usage(inputs.lsv[i] + ": is given for two sensors; each has a file of its own");
    }
  }
  if (inputs.lsv.empty() && inputs.wheels.empty())
    return usage("give --lsv, --wheels or both: nothing else tells how far the rover went");
  return {};
}

}  // namespace

Result<FuseSamples> read_samples(const FuseInputs& inputs, const FusionConfig& config) {
  if (Result<void> ok = fits(inputs, config); !ok) return ok.error();
  FuseSamples out;
  RestWords rest;
  std::vector<Result<std::optional<TimeRange>>> added;
  for (std::size_t i = 0; i < inputs.lsv.size(); ++i) {
    added.push_back(add_lsv(inputs.lsv[i], i, out, rest));
    if (!added.back()) return added.back().error();
  }
  std::ranges::copy(rest.standstills(), std::back_inserter(out.samples));
  if (!inputs.wheels.empty()) added.push_back(add_wheels(inputs.wheels, out));
  if (!added.back()) return added.back().error();
  if (!inputs.imu.empty()) added.push_back(add_imu(inputs.imu, out));
  if (!added.back()) return added.back().error();
  std::vector<TimeRange> ranges;
  for (const auto& range : added) {
    if (range.value()) ranges.push_back(*range.value());
  }
  if (Result<void> one = are_of_one_clock(std::move(ranges)); !one) return one.error();
  if (out.samples.empty())
    return Error{ErrorCode::bad_input, "the files hold no sample that can be used"};
  std::ranges::stable_sort(out.samples, {}, &FuseSample::when);
  return out;
}

}  // namespace lsv::cli
