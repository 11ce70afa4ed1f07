/// @file
/// Room `contact`, private: prepared mesh shapes on disk, named by their content.
#pragma once

#include <string>

#include "contact/mesh_field.h"

namespace tissue_contact {

/// 32 hexadecimal digits from the mesh's vertices and triangles (scale applied), the options and the file format.
std::string fieldKey(const TriangleMesh& mesh, double sample_count);

/// False when there is no such file or it is damaged, foreign or of another size than it says; `field` is then
/// unchanged. An empty directory is no cache.
bool readField(const std::string& directory, const std::string& key, MeshField& field);

/// Writes beside its place, then renames: readers and other writers see a whole file or none. Then removes the oldest
/// files beyond a quarter of a gigabyte. @return why it was not written; empty when all went well or there is no cache.
std::string writeField(const std::string& directory, const std::string& key, const MeshField& field);

}  // namespace tissue_contact
