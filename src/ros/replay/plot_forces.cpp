#include "ros/replay/plot_forces.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <filesystem>
#include <stdexcept>
#include <system_error>

namespace tissue_contact {

void plotForces(const std::string& bag, const std::string& scene, const std::string& folder) {
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  std::array<std::string, 7> words = {
      (self.parent_path() / "plot_forces.py").string(), "--bag", bag, "--scene", scene, "--output", folder};
  std::array<char*, words.size() + 1> arguments{};
  for (std::size_t i = 0; i < words.size(); ++i) arguments[i] = words[i].data();
  pid_t child = 0;
  const int refused = posix_spawn(&child, words[0].c_str(), nullptr, nullptr, arguments.data(), environ);
  if (refused != 0) {
    throw std::runtime_error("--plot: cannot run '" + words[0] + "': " + std::generic_category().message(refused));
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (status != 0) throw std::runtime_error("--plot: plot_forces.py failed; '" + bag + "' is complete");
}

}  // namespace tissue_contact
