/// @file
/// A locale that writes one half as 0,5, for tests that numbers are read the same in any.
#pragma once

#include <clocale>
#include <cstdlib>
#include <string>

#include "support/temporary_directory.h"

namespace tissue_contact {

/// While it lives, the process has such a locale, if the system has one or can make one (localedef).
class CommaLocale {
 public:
  CommaLocale() {
    const std::string make =
        "localedef -i de_DE -f UTF-8 " + (directory_.path() / "de_DE.UTF-8").string() + " 2>/dev/null";
    const bool made = std::setlocale(LC_ALL, "de_DE.UTF-8") == nullptr && std::system(make.c_str()) == 0;
    if (made) setenv("LOCPATH", directory_.path().c_str(), 1);
    std::setlocale(LC_ALL, "de_DE.UTF-8");
  }
  ~CommaLocale() {
    std::setlocale(LC_ALL, "C");
    unsetenv("LOCPATH");
  }
  CommaLocale(const CommaLocale&) = delete;
  CommaLocale& operator=(const CommaLocale&) = delete;

  bool isOn() const { return std::string(std::localeconv()->decimal_point) == ","; }

 private:
  TemporaryDirectory directory_;
};

}  // namespace tissue_contact
