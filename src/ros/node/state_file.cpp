#include "ros/node/state_file.h"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "ros/absolute_path.h"
#include "tissue_contact/core/read_file.h"
#include "tissue_contact/core/text.h"
#include "tissue_contact/core/whole_file.h"

namespace tissue_contact {
namespace {

/// Of a scene with a million nodes.
constexpr std::uintmax_t kMostBytes = 4'000'000'000;

constexpr std::size_t kMostLetters = 4096;  // of a path

void requireName(const std::string& file) {
  if (file.empty()) throw std::invalid_argument("no file is named; give the path of one, such as /tmp/press.state");
  if (file.find('\0') != std::string::npos) throw std::invalid_argument("the name of the file has a byte 0 in it");
}

bool beginsAsState(const std::string& file) {
  const std::string title = JointStatePlayer::stateTitle();
  std::string begins(title.size(), '\0');
  std::ifstream(file, std::ios::binary).read(begins.data(), static_cast<std::streamsize>(begins.size()));
  return begins == title;
}

void requireReplaceable(const std::string& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error) || std::filesystem::file_size(file, error) == 0) return;
  if (beginsAsState(file)) return;
  throw std::invalid_argument("'" + printable(absolutePath(file), kMostLetters) +
                              "' is there already and is no saved state, so it is not replaced; name another file");
}

std::string told(const std::string& file, std::size_t bytes) {
  return printable(absolutePath(file), kMostLetters) + " (" + std::to_string((bytes + 999) / 1000) + " kB)";
}

}  // namespace

std::string saveStateFile(JointStatePlayer& player, const std::string& file) {
  requireName(file);
  requireReplaceable(file);
  const std::string state = player.saveState();
  WholeFile whole(file);
  whole.stream().write(state.data(), static_cast<std::streamsize>(state.size()));
  whole.commit();
  return told(file, state.size());
}

std::string loadStateFile(JointStatePlayer& player, const std::string& file) {
  requireName(file);
  const std::string name = printable(absolutePath(file), kMostLetters);
  requireRegularFile(file, "saved state", kMostBytes);
  if (!beginsAsState(file)) {
    throw std::invalid_argument("'" + name + "' does not begin with '" + JointStatePlayer::stateTitle() +
                                "': it is no saved state, or one of another version");
  }
  const std::string state = readFile(file, "saved state", kMostBytes);
  try {
    player.restoreState(state);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument("'" + name + "' is not loaded, and nothing has changed: " + error.what());
  }
  return told(file, state.size());
}

}  // namespace tissue_contact
