#include "ros/run_script.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <stdexcept>
#include <system_error>

namespace tissue_contact {

void runScript(const std::string& name, std::vector<std::string> arguments, int standard_input) {
  std::string script = (std::filesystem::read_symlink("/proc/self/exe").parent_path() / name).string();
  std::vector<char*> words = {script.data()};
  for (std::string& argument : arguments) words.push_back(argument.data());
  words.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  if (standard_input >= 0) posix_spawn_file_actions_adddup2(&actions, standard_input, STDIN_FILENO);
  pid_t child = 0;
  const int refused = posix_spawn(&child, script.c_str(), &actions, nullptr, words.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (refused != 0) {
    throw std::runtime_error("cannot run '" + script + "': " + std::generic_category().message(refused));
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (status != 0) throw std::runtime_error(name + " failed");
}

}  // namespace tissue_contact
