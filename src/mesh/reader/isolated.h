/// @file
/// Room `mesh` (private): work that may crash, in a process of its own.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace tissue_contact {

/// Runs `work` in a child process and returns what it returned. assimp 5.2 dereferences null pointers, recurses without
/// end and allocates without end on malformed Collada files (mutating a valid one shows each within some thousand
/// tries), which no check before or after can cover; a simulation must not die of its input.
///
/// The child starts as a copy of this process (fork), sees all its data and can change none of it. Locks that another
/// thread holds at that moment stay locked there, so `work` may allocate and read files but should wait for nobody; if
/// it hangs all the same, the time limit ends it. Meant for start-up: it costs some milliseconds.
///
/// @param seconds wall time the child may take.
/// @param bytes memory it may take beyond what this process has.
/// @throws std::invalid_argument with the message of an exception that `work` let out, or saying that it crashed, or
///   exceeded its time or memory.
/// @throws std::system_error when no process can be started.
std::string runIsolated(const std::function<std::string()>& work, unsigned seconds, std::size_t bytes);

}  // namespace tissue_contact
