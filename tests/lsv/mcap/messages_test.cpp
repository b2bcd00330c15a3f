// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/mcap/messages.h"

#include <gtest/gtest.h>

#include <cmath>
#include <type_traits>

#include "lsv/mcap/message_fields.h"
#include "lsv/mcap/sealed.h"

namespace lsv {
namespace {

using mcap::Bytes;

/// Every field another value.
StepReport distinct_step() {
  StepReport step;
  int next = 1;
  mcap::visit_fields(step, [&next](std::string_view, auto& value) {
    using Value = std::remove_reference_t<decltype(value)>;
    if constexpr (std::is_enum_v<Value>)
      value = mcap::AllOf<Value>::kValues.back();
    else
      value = static_cast<Value>(next++) * Value{3} / Value{2};
  });
  return step;
}

TEST(StepMessage, KeepsEveryBit) {
  StepReport step = distinct_step();
  step.shift.dx_px = 0.1 + 0.2;
  step.shift.dy_px = -0.0;
  step.velocity.vx_m_s = kUnknown;
  Bytes message;
  mcap::encode(step, message);
  const auto back = mcap::decode<StepReport>(message);
  ASSERT_TRUE(back.has_value());
  EXPECT_EQ(mcap::first_difference(step, *back), "");
  EXPECT_EQ(back->shift.dx_px, 0.1 + 0.2);
  EXPECT_TRUE(std::signbit(back->shift.dy_px));
  EXPECT_TRUE(std::isnan(back->velocity.vx_m_s));
  EXPECT_EQ(back->stamp.ns, step.stamp.ns);
  EXPECT_EQ(back->position.sigma_y_m, step.position.sigma_y_m);
  EXPECT_EQ(back->shift.status, ShiftStatus::below_q_gate);
  EXPECT_EQ(back->motion, MotionState::moving);
  EXPECT_EQ(back->static_share, step.static_share);
}

TEST(StepMessage, EveryFieldCountsInTheComparison) {
  const StepReport step = distinct_step();
  int fields = 0;
  mcap::visit_fields(step, [&fields](std::string_view, const auto&) { ++fields; });
  for (int changed = 0; changed < fields; ++changed) {
    StepReport other = step;
    int field = 0;
    std::string name_of_changed;
    mcap::visit_fields(other, [&](std::string_view name, auto& value) {
      if (field++ != changed) return;
      name_of_changed = name;
      using Value = std::remove_reference_t<decltype(value)>;
      if constexpr (std::is_same_v<Value, double>)
        value = std::nextafter(value, 1e9);
      else if constexpr (std::is_enum_v<Value>)
        value = mcap::AllOf<Value>::kValues.front();
      else
        value += 1;
    });
    EXPECT_EQ(mcap::first_difference(step, other).substr(0, name_of_changed.size() + 1),
              name_of_changed + ":");
  }
}

TEST(StepMessage, MalformedIsRefusedAtEveryLength) {
  Bytes message;
  mcap::encode(distinct_step(), message);
  for (std::size_t size = 0; size < message.size(); ++size)
    EXPECT_FALSE(mcap::decode<StepReport>(mcap::ByteView(message).first(size)).has_value()) << size;
  message[1] = std::byte{0};  // big-endian
  EXPECT_FALSE(mcap::decode<StepReport>(message).has_value());
}

TEST(StepMessage, AnUnknownWordIsRefused) {
  Bytes message;
  mcap::encode(distinct_step(), message);
  const std::string_view word = "below_q_gate";
  const std::size_t at = mcap::text_of(message).find(word);
  ASSERT_NE(at, std::string_view::npos);
  message[at] = std::byte{'B'};
  EXPECT_FALSE(mcap::decode<StepReport>(message).has_value());
}

TEST(EventMessage, KeepsSeverityNameAndText) {
  for (const mcap::Severity severity :
       {mcap::Severity::info, mcap::Severity::warning, mcap::Severity::error}) {
    Bytes message;
    mcap::encode(mcap::Event{.stamp_ns = 1'700'000'000'123'456'789,
                             .severity = severity,
                             .name = "source_lost",
                             .text = "No frame."},
                 message);
    const auto back = mcap::decode<mcap::Event>(message);
    ASSERT_TRUE(back.has_value());
    EXPECT_EQ(back->severity, severity);
    EXPECT_EQ(back->stamp_ns, 1'700'000'000'123'456'789);
    EXPECT_EQ(back->name, "source_lost");
    EXPECT_EQ(back->text, "No frame.");
  }
}

TEST(ImageMessage, Keeps16BitPixelsAndTheStampBefore1970) {
  Frame frame({.width_px = 3, .height_px = 2, .type = PixelType::mono16, .bit_depth = 12});
  frame.stamp.ns = -1'500'000'000;
  for (int y = 0; y < 2; ++y) {
    for (int x = 0; x < 3; ++x) frame.row16(y)[x] = static_cast<std::uint16_t>(1000 * y + x);
  }
  Bytes message;
  mcap::encode_image(frame.view(), message);
  const auto image = mcap::decode_image(message);
  ASSERT_TRUE(image.has_value());
  EXPECT_EQ(image->stamp_ns, -1'500'000'000);
  EXPECT_EQ(image->encoding, "mono16");
  EXPECT_EQ(image->width_px, 3U);
  EXPECT_EQ(image->step_bytes, 6U);
  ASSERT_EQ(image->data.size(), 12U);
  std::uint16_t last = 0;
  std::memcpy(&last, image->data.data() + 10, 2);
  EXPECT_EQ(last, 1002);
}

TEST(SealedMetadata, NoticesAnyChange) {
  const mcap::Metadata sealed = mcap::sealed({.name = "a", .entries = {{"k", "v"}, {"l", "w"}}});
  EXPECT_TRUE(mcap::is_sealed(sealed));
  EXPECT_FALSE(mcap::is_sealed({.name = "a", .entries = {{"k", "v"}}}));
  for (mcap::Metadata changed : {sealed, sealed, sealed}) {
    static int round = 0;
    if (round == 0) changed.name = "b";
    if (round == 1) changed.entries["k"] = "V";
    if (round == 2) changed.entries.erase("l");
    ++round;
    EXPECT_FALSE(mcap::is_sealed(changed));
  }
}

}  // namespace
}  // namespace lsv
