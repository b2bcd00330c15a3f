// SPDX-License-Identifier: BSD-3-Clause
// Tables come back from the MCAP file row by row, in the order of time, unknown as null.
#include "tools/tables_mcap.h"

#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "lsv/mcap/byte_source.h"
#include "lsv/mcap/reader.h"
#include "tests/support/run_program.h"

namespace lsv::cli {
namespace {

struct ReadBack {
  std::vector<std::int64_t> times_ns;
  std::map<std::string, std::vector<nlohmann::json>> rows;  // by topic
  std::map<std::string, nlohmann::json> schemas;
};

ReadBack read_back(const std::string& path) {
  ReadBack out;
  auto reader = mcap::Reader::open(mcap::open_file(path).value(), mcap::Damage::refuse);
  if (!reader) throw std::runtime_error(reader.error().message);
  while (true) {
    const auto item = reader.value().next();
    if (!item) throw std::runtime_error(item.error().message);
    if (item.value() == mcap::Item::end) return out;
    const mcap::Message& message = reader.value().message();
    const auto* text = reinterpret_cast<const char*>(message.payload.data());
    out.times_ns.push_back(message.log_time_ns);
    out.rows[message.channel->topic].push_back(
        nlohmann::json::parse(text, text + message.payload.size()));
    out.schemas[message.channel->topic] = nlohmann::json::parse(message.channel->schema.text);
  }
}

TEST(TablesMcap, ComesBackInTheOrderOfTimeWithUnknownAsNull) {
  const std::string path = test::fresh_directory() + "/tables.mcap";
  ASSERT_TRUE(write_tables_mcap(
      path, {{"/wheels", "# a note\ntime_s,left_rad_s\n0.0,0.55\n0.2,-0.5\n"},
             {"/lsv_1", "time_s,vx_m_s,status\n0.1,,dark\n0.3,0.001,ok\n0.4,nan,dark\n"}}));
  const ReadBack back = read_back(path);
  EXPECT_EQ(back.times_ns,
            (std::vector<std::int64_t>{0, 100000000, 200000000, 300000000, 400000000}));
  const auto& wheels = back.rows.at("/wheels");
  ASSERT_EQ(wheels.size(), 2U);
  EXPECT_EQ(wheels[0], nlohmann::json({{"time_s", 0.0}, {"left_rad_s", 0.55}}));
  EXPECT_EQ(wheels[1], nlohmann::json({{"time_s", 0.2}, {"left_rad_s", -0.5}}));
  const auto& lsv = back.rows.at("/lsv_1");
  ASSERT_EQ(lsv.size(), 3U);
  EXPECT_EQ(lsv[0], nlohmann::json({{"time_s", 0.1}, {"vx_m_s", nullptr}, {"status", "dark"}}));
  EXPECT_EQ(lsv[1], nlohmann::json({{"time_s", 0.3}, {"vx_m_s", 0.001}, {"status", "ok"}}));
  EXPECT_TRUE(lsv[2]["vx_m_s"].is_null());
  EXPECT_EQ(back.schemas.at("/lsv_1")["properties"]["vx_m_s"]["type"], "number");
  EXPECT_EQ(back.schemas.at("/lsv_1")["properties"]["status"]["type"], "string");
}

TEST(TablesMcap, AFileThatIsThereIsKept) {
  const std::string path = test::fresh_directory() + "/tables.mcap";
  const std::vector<TopicTable> tables = {{"/a", "time_s,x_m\n0,1\n"}};
  ASSERT_TRUE(write_tables_mcap(path, tables));
  EXPECT_FALSE(write_tables_mcap(path, tables));
}

}  // namespace
}  // namespace lsv::cli
