// SPDX-License-Identifier: BSD-3-Clause
// Errors as values: what every call that can fail hands back.
// The library never prints, aborts or exits; a message is one sentence that names the file,
// the field and what to do next, and is fit to be shown to a user as it is.
#pragma once

#include <string>
#include <utility>
#include <variant>

namespace lsv {

enum class ErrorCode {
  invalid_argument,  // the caller asked for something that cannot be done (a usage error)
  bad_input,         // a file, stream or frame is malformed, truncated or contradicts itself
  unsupported,       // well-formed input of a kind that lsv does not read
  output_failed,     // a result could not be written completely
};

struct Error {
  ErrorCode code;
  std::string message;
};

/// A value or the error that prevented it. Asking for the side that is not there throws
/// std::bad_variant_access: check first.
template <typename T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}
  Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}

  bool ok() const { return state_.index() == 0; }
  explicit operator bool() const { return ok(); }

  T& value() & { return std::get<0>(state_); }
  const T& value() const& { return std::get<0>(state_); }
  T&& value() && { return std::get<0>(std::move(state_)); }

  const Error& error() const { return std::get<1>(state_); }

 private:
  std::variant<T, Error> state_;
};

template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}

  bool ok() const { return state_.index() == 0; }
  explicit operator bool() const { return ok(); }
  const Error& error() const { return std::get<1>(state_); }

 private:
  std::variant<std::monostate, Error> state_;
};

}  // namespace lsv
