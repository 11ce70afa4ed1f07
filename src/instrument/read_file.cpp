#include "read_file.h"

#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <system_error>

#include "tissue_contact/core/stand_in_file.h"

namespace tissue_contact {

void requireRegularFile(const std::string& file, const std::string& what, std::uintmax_t max_bytes) {
  const std::string start = what + " '" + file + "' ";
  if (const std::string problem = standInProblem(file); !problem.empty()) throw std::invalid_argument(start + problem);
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  if (status.type() == std::filesystem::file_type::not_found) throw std::invalid_argument(start + "does not exist");
  if (error) throw std::invalid_argument(start + "cannot be read: " + error.message());
  if (!std::filesystem::is_regular_file(status)) throw std::invalid_argument(start + "is not a regular file");
  const std::uintmax_t bytes = std::filesystem::file_size(file, error);
  if (error) throw std::invalid_argument(start + "cannot be read: " + error.message());
  if (bytes == 0) throw std::invalid_argument(start + "is empty");
  if (bytes > max_bytes) {
    throw std::invalid_argument(start + "has " + std::to_string(bytes) + " bytes; at most " +
                                std::to_string(max_bytes) + " are read");
  }
  if (!std::ifstream(file, std::ios::binary)) throw std::invalid_argument(start + "cannot be opened for reading");
}

std::string readFile(const std::string& file, const std::string& what, std::uintmax_t max_bytes) {
  requireRegularFile(file, what, max_bytes);
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream content;
  content << stream.rdbuf();
  if (!stream || !content) throw std::invalid_argument(what + " '" + file + "' cannot be read to its end");
  return content.str();
}

}  // namespace tissue_contact
