/// @file
/// Room `core`: errors about an entry of a scene. Whoever builds something from a scene says where in the scene he is
/// (atEntry), whoever finds something wrong need not know; the scene turns the entry into file and line (placeOf()).
#pragma once

#include <exception>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>

namespace tissue_contact {

/// Something wrong with an entry of a scene. what() does not repeat the entry.
class EntryError : public std::invalid_argument {
 public:
  /// @param entry path of keys below what is being built, "regions[1].where"; may be empty.
  EntryError(std::string entry, const std::string& problem)
      : std::invalid_argument(problem), entry_(std::move(entry)) {}
  const std::string& entry() const { return entry_; }

 private:
  std::string entry_;
};

/// "name[index]".
inline std::string elementOf(const std::string& name, std::size_t index) {
  return name + "[" + std::to_string(index) + "]";
}

/// Does `work`. What it throws comes out as an EntryError of `entry`, or of an entry below it where an EntryError says
/// which.
template <typename Work>
decltype(auto) atEntry(const std::string& entry, Work&& work) {
  try {
    return std::forward<Work>(work)();
  } catch (const EntryError& error) {
    const bool both = !entry.empty() && !error.entry().empty();
    throw EntryError(entry + (both ? "." : "") + error.entry(), error.what());
  } catch (const std::bad_alloc&) {
    throw EntryError(entry, "needs more memory than there is; use a coarser mesh, or a machine with more memory");
  } catch (const std::exception& error) {
    throw EntryError(entry, error.what());
  }
}

}  // namespace tissue_contact
