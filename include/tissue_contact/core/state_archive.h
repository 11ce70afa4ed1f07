/// @file
/// Room `core`: the state of a simulation as bytes. One function of a class, `carry(StateArchive&)`, both writes its state and
/// reads it, so that the two cannot differ.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace tissue_contact {

/// Values are stored as the machine has them, so that they come back to the same bits; what is read must have the sizes that the
/// reader has already, or keep to a bound, so that nothing a file says takes memory without limit. The end holds a checksum.
///
/// Reading throws std::invalid_argument naming the section for whatever does not fit: callers put back what they had.
class StateArchive {
 public:
  /// To write. The bytes begin with `title`, which names kind and version of what is saved.
  explicit StateArchive(const std::string& title);
  /// To read. @throws std::invalid_argument when the bytes do not begin with `title`, end early, or were changed.
  StateArchive(const std::string& title, std::string bytes);

  bool isReading() const { return reading_; }

  /// Names what follows, for messages, and is checked on reading.
  void section(const std::string& name);

  void carry(bool& value);
  /// A number or enumerator.
  template <typename Value, std::enable_if_t<std::is_arithmetic_v<Value> || std::is_enum_v<Value>, int> = 0>
  void carry(Value& value) {
    bytes(&value, sizeof value);
  }

  /// Of a size that is known to the reader.
  template <typename Derived>
  void carry(Eigen::PlainObjectBase<Derived>& matrix) {
    requireSize(static_cast<std::uint64_t>(matrix.size()));
    bytes(matrix.data(), sizeof(typename Derived::Scalar) * static_cast<std::size_t>(matrix.size()));
  }
  template <typename Value, std::size_t count>
  void carry(std::array<Value, count>& values) {
    for (Value& value : values) carry(value);
  }
  template <typename Value>
  void carry(std::vector<Value>& values) {
    requireSize(values.size());
    for (Value& value : values) carry(value);
  }
  void carry(std::vector<bool>& values);

  /// Likewise, of what has parts.
  template <typename Value, typename Carry>
  void carryEach(std::vector<Value>& values, const Carry& carry_one) {
    requireSize(values.size());
    for (Value& value : values) carry_one(value);
  }

  /// Of a size that may differ, up to `most`.
  template <typename Value, typename Carry>
  void carryList(std::vector<Value>& values, std::size_t most, const Carry& carry_one) {
    values.resize(carrySize(values.size(), most));
    for (Value& value : values) carry_one(value);
  }

  template <typename Value>
  void carry(std::optional<Value>& value) {
    bool is_there = value.has_value();
    carry(is_there);
    if (!is_there) value.reset();
    if (is_there && !value) value.emplace();
    if (is_there) carry(*value);
  }

  /// What the reader knows and the writer must have had. @param meaning ends the message: "is of another mesh".
  void require(std::uint64_t known, const std::string& meaning);

  /// Refuses what was read unless it is possible, naming the section. @param reason what is wrong with it.
  void check(bool is_possible, const char* reason) const {
    if (reading_ && !is_possible) refuse(reason);
  }
  /// The same for an index that must lie in [least, count).
  void requireIndex(int index, int least, std::size_t count, const char* what) const;

  /// Ends writing: all bytes. @pre !isReading().
  std::string finish();
  /// Ends reading: refuses what is left over.
  void requireEnd() const;

 private:
  [[noreturn]] void refuse(const std::string& reason) const;
  void bytes(void* data, std::size_t size);
  void requireSize(std::uint64_t size);
  std::size_t carrySize(std::size_t size, std::size_t most);

  bool reading_;
  std::string bytes_;
  std::size_t at_ = 0;   ///< next byte to read
  std::size_t end_ = 0;  ///< of what is read, before the checksum
  std::string section_;
};

/// Reads `state` by `carry(StateArchive&)`. If that fails, reads what `save()` gave before, and if that failed or cannot be read either,
/// because what was saved there had run away, calls reset(); and throws what the first threw. Of what is no saved state, or damaged, nothing
/// of all this is done.
template <typename Carry, typename Save, typename Reset>
void restoreOrPutBack(const std::string& title, const std::string& state, const Save& save, const Carry& carry,
                      const Reset& reset) {
  const auto read = [&](StateArchive archive) {
    carry(archive);
    archive.requireEnd();
  };
  StateArchive archive(title, state);
  std::string before;
  try {
    before = save();
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception&) {  // no state at all: not to be read below
  }
  try {
    read(std::move(archive));
  } catch (const std::exception&) {
    try {
      read(StateArchive(title, before));
    } catch (const std::exception&) {
      reset();
    }
    throw;
  }
}

}  // namespace tissue_contact
