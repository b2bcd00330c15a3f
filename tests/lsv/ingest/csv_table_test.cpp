// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/ingest/csv_table.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lsv {
namespace {

TEST(CsvTable, FindsColumnsByName) {
  const Result<CsvTable> read =
      CsvTable::parse("# made by hand\r\n\nb , a,note\r\n1, -2.5e-3 ,x y\n,+4,\n", "t.csv");
  ASSERT_TRUE(read) << read.error().message;
  const CsvTable& table = read.value();
  ASSERT_EQ(table.rows(), 2U);
  const std::size_t a = table.column("a").value();
  EXPECT_EQ(table.number(0, a).value(), -2.5e-3);
  EXPECT_EQ(table.number(1, a).value(), 4.0);
  EXPECT_TRUE(std::isnan(table.number(1, table.column("b").value()).value()));
  EXPECT_EQ(table.text(0, table.column("note").value()), "x y");
  EXPECT_EQ(table.text(1, table.column("note").value()), "");
  EXPECT_EQ(table.line(1), 5U);
  EXPECT_FALSE(table.has("c"));
}

TEST(CsvTable, ErrorsNameFileLineAndColumn) {
  EXPECT_EQ(CsvTable::parse("a,b\n1,2,3\n", "t.csv").error().message,
            "t.csv:2: 3 cells under 2 columns");
  EXPECT_FALSE(CsvTable::parse("", "t.csv"));
  EXPECT_FALSE(CsvTable::parse("# a\n", "t.csv"));
  const CsvTable table = CsvTable::parse("a,b\n1,two\n,nan\n", "t.csv").value();
  EXPECT_EQ(table.column("c").error().message, "t.csv: no column c; there are a, b");
  EXPECT_EQ(table.number(0, 1).error().message, "t.csv:2: b is \"two\", not a number");
  EXPECT_FALSE(table.number(1, 1));
  EXPECT_EQ(table.known_number(1, 0).error().message, "t.csv:3: a is empty");
  EXPECT_FALSE(CsvTable::read("no/such.csv"));
  EXPECT_FALSE(CsvTable::read("."));
}

}  // namespace
}  // namespace lsv
