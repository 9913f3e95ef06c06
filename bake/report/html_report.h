// This file writes the report of a verification as one page that needs no other file.
#pragma once

#include <string>

#include "bake/check/verify.h"
#include "bake/recipe/recipe.h"

namespace sunbeam {

struct ReportSource {
  const Table& table;
  const Recipe& recipe;
  const VerifySettings& settings;
  const VerifyReport& report;
  std::string table_name;  // file name
  std::uintmax_t table_bytes;
  std::string command;  // that makes this report again
};

std::string html_report(const ReportSource& source);

}  // namespace sunbeam
