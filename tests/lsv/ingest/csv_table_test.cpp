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
  EXPECT_EQ(CsvTable::read(".").error().message, ".: is a folder, not a file");
}

// As spreadsheets write UTF-8; the mark is no part of the first name or of a comment.
TEST(CsvTable, AByteOrderMarkDoesNotCount) {
  for (const char* const text :
       {"\xEF\xBB\xBFtime_s,a\n1,2\n", "\xEF\xBB\xBF# made\ntime_s,a\n1,2\n"}) {
    const Result<CsvTable> table = CsvTable::parse(text, "t.csv");
    ASSERT_TRUE(table) << table.error().message;
    EXPECT_EQ(table.value().number(0, table.value().column("time_s").value()).value(), 1.0);
    EXPECT_EQ(table.value().bytes(), text);
  }
}

// Which of both is meant, nobody knows.
TEST(CsvTable, AColumnIsThereOnce) {
  EXPECT_EQ(CsvTable::parse("# x\na, b,c,b\n1,2,3,4\n", "t.csv").error().message,
            "t.csv:2: the column b is there twice");
  EXPECT_TRUE(CsvTable::parse("a,,\n1,2,3\n", "t.csv"));
}

}  // namespace
}  // namespace lsv
