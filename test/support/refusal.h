/// @file
/// Test helper: what bad input is refused with.
#pragma once

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

namespace tissue_contact {

/// Message of the `Error` that `action` must throw; the test fails when it throws none.
template <typename Error = std::invalid_argument, typename Action>
std::string refusal(const Action& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  ADD_FAILURE() << "nothing was refused";
  return "";
}

/// Fails unless `text` contains every one of `parts`.
inline void expectContains(const std::string& text, const std::vector<std::string>& parts) {
  for (const std::string& part : parts) EXPECT_NE(text.find(part), std::string::npos) << part << " is not in: " << text;
}

/// `action` must be refused in words that hold all of `parts`.
template <typename Error = std::invalid_argument, typename Action>
void expectRefusal(const Action& action, const std::vector<std::string>& parts) {
  expectContains(refusal<Error>(action), parts);
}

}  // namespace tissue_contact
